#include "common/sampling/pixel_sampler.h"

#include <Random123/philox.h>

namespace rayfarm {

std::array<double, 2> random_pair(uint64_t seed, int frame, int x, int y, uint32_t sample,
                                  RandomDimension dimension) {
  const r123::Philox4x32::ctr_type counter{
      {static_cast<uint32_t>(x), static_cast<uint32_t>(y), sample, static_cast<uint32_t>(dimension)}};
  // The frame is mixed into the key: every frame has its own noise, and the same on every node.
  const r123::Philox4x32::key_type key{
      {static_cast<uint32_t>(seed),
       static_cast<uint32_t>(seed >> 32) ^ (static_cast<uint32_t>(frame) * 0x9e3779b9u)}};
  const auto r = r123::Philox4x32()(counter, key);
  const auto unit = [](uint32_t high, uint32_t low) {
    return static_cast<double>((uint64_t{high} << 32 | low) >> 11) * 0x1p-53;
  };
  return {unit(r[0], r[1]), unit(r[2], r[3])};
}

Strata make_strata(uint32_t samples) {
  Strata strata{samples, 1};
  for (uint32_t rows = 1; rows * rows <= samples; ++rows)
    if (samples % rows == 0) strata = {samples / rows, rows};
  return strata;
}

Stratum stratum_of(const Strata& strata, uint32_t sample) {
  const Vec2 size(1.0 / strata.columns, 1.0 / strata.rows);
  return {Vec2(sample % strata.columns, sample / strata.columns) * size, size};
}

Vec2 sample_place(const RenderSettings& settings, const Stratum& stratum, int frame, int x, int y,
                  uint32_t sample) {
  double u = 0.5, v = 0.5;
  if (settings.sampling == SamplingPattern::jittered) {
    const auto r = random_pair(settings.seed, frame, x, y, sample, RandomDimension::screen);
    u = r[0];
    v = r[1];
  }
  return stratum.corner + Vec2(u, v) * stratum.size;
}

}  // namespace rayfarm
