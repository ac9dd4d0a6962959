#include "common/sampling/sampler.h"

#include <limits>

namespace rayfarm {
namespace {

/// Owen's scrambling by hashing (Laine and Karras 2011, section 3; Burley 2020, "Practical hash-based Owen
/// scrambling"): every bit is flipped by a function of the bits below it, so numbers come and go with their
/// bits reversed.
uint32_t owen_scrambled_reversed(uint32_t x, uint32_t seed) {
  x += seed;
  x ^= x * 0x6c50b47cu;
  x ^= x * 0xb82f1e52u;
  x ^= x * 0xc7afe638u;
  x ^= x * 0x8d22f6e6u;
  return x;
}

/// The second dimension of Sobol's sequence with its bits reversed; the first, so reversed, is the index. Its
/// matrix is Pascal's triangle modulo 2, which is [1 1; 0 1] within itself five times over.
uint32_t sobol_second_reversed(uint32_t index) {
  index ^= index >> 16;
  index ^= (index & 0xff00ff00u) >> 8;
  index ^= (index & 0xf0f0f0f0u) >> 4;
  index ^= (index & 0xccccccccu) >> 2;
  return index ^ (index & 0xaaaaaaaau) >> 1;
}

Vec2 sobol_point(uint32_t sample, uint64_t key) {
  const uint64_t keys = mix_bits(key), more = mix_bits(keys);
  const uint32_t index =
      reversed_bits(owen_scrambled_reversed(reversed_bits(sample), static_cast<uint32_t>(more)));
  const uint32_t x = owen_scrambled_reversed(index, static_cast<uint32_t>(keys)),
                 y = owen_scrambled_reversed(sobol_second_reversed(index), static_cast<uint32_t>(keys >> 32));
  return {0x1p-32 * reversed_bits(x), 0x1p-32 * reversed_bits(y)};
}

double torus_distance2(const Vec2& a, const Vec2& b) {
  const Vec2 d = glm::abs(a - b), wrapped = glm::min(d, 1.0 - d);
  return glm::dot(wrapped, wrapped);
}

/// Poisson disks by the best of several candidates (Mitchell 1991), on a torus.
std::vector<Vec2> make_poisson(uint32_t samples, uint64_t seed) {
  constexpr uint32_t kCandidates = 40;  // per point
  std::vector<Vec2> points;
  for (uint32_t i = 0; i < samples; ++i) {
    Vec2 best(0);
    double farthest = -1;
    for (uint32_t k = 0; k < (i == 0 ? 1 : kCandidates); ++k) {
      const auto r = random_pair(seed, 0, {static_cast<int>(k), 0, i}, dimension::kPattern);
      const Vec2 candidate(r[0], r[1]);
      double nearest = std::numeric_limits<double>::infinity();
      for (const Vec2& p : points) nearest = std::min(nearest, torus_distance2(p, candidate));
      if (nearest > farthest) {
        farthest = nearest;
        best = candidate;
      }
    }
    points.push_back(best);
  }
  return points;
}

}  // namespace

uint32_t reversed_bits(uint32_t x) {
  x = x >> 16 | x << 16;
  x = (x & 0xff00ff00u) >> 8 | (x & 0x00ff00ffu) << 8;
  x = (x & 0xf0f0f0f0u) >> 4 | (x & 0x0f0f0f0fu) << 4;
  x = (x & 0xccccccccu) >> 2 | (x & 0x33333333u) << 2;
  return (x & 0xaaaaaaaau) >> 1 | (x & 0x55555555u) << 1;
}

Strata make_strata(uint32_t samples) {
  Strata strata{samples, 1};
  for (uint32_t rows = 1; rows * rows <= samples; ++rows)
    if (samples % rows == 0) strata = {samples / rows, rows};
  return strata;
}

Sampler::Sampler(const SamplerSettings& settings, int frame)
    : pattern_(settings.pattern),
      samples_(settings.samples),
      seed_(settings.seed),
      seed_bits_(mix_bits(settings.seed)),
      frame_(frame),
      strata_(make_strata(settings.samples)) {
  if (pattern_ == SamplingPattern::poisson) poisson_ = make_poisson(samples_, seed_);
}

Vec2 Sampler::point(const SampleId& id, uint32_t dimension) const {
  const bool is_screen = dimension == dimension::kScreen;
  // A key for the pixel and the dimension, common to its samples.
  const auto key = [&] { return mix_bits(pixel_key(id) ^ frame_and_dimension(dimension)); };
  const auto jitter = [&] {
    const auto r = random_pair(seed_, frame_, id, dimension);
    return Vec2(r[0], r[1]);
  };
  const auto in_cell = [&](uint32_t cell, const Vec2& place) {
    return (Vec2(cell % strata_.columns, cell / strata_.columns) + place) /
           Vec2(strata_.columns, strata_.rows);
  };
  switch (pattern_) {
    case SamplingPattern::corners:  // on the screen they stand at the pixels' corners
    case SamplingPattern::sobol:
      if (is_screen && samples_ == 1) return Vec2(0.5);
      return sobol_point(id.sample, key());
    case SamplingPattern::regular:
      return in_cell(is_screen ? id.sample : permuted(id.sample, samples_, key()), Vec2(0.5));
    case SamplingPattern::jittered:
      return in_cell(id.sample, jitter());
    case SamplingPattern::uncorrelated:
      return in_cell(is_screen ? id.sample : permuted(id.sample, samples_, key()), jitter());
    case SamplingPattern::n_rooks:
      return (Vec2(is_screen ? id.sample : permuted(id.sample, samples_, key()),
                   permuted(id.sample, samples_, ~key())) +
              jitter()) /
             static_cast<double>(samples_);
    case SamplingPattern::poisson: {
      const uint64_t pixel_key = key();
      const Vec2 shift(0x1p-32 * static_cast<uint32_t>(pixel_key),
                       0x1p-32 * static_cast<uint32_t>(pixel_key >> 32));
      const uint32_t i = is_screen ? id.sample : permuted(id.sample, samples_, mix_bits(pixel_key));
      const Vec2 p = poisson_[i] + shift;
      return p - glm::floor(p);
    }
  }
  return Vec2(0.5);
}

}  // namespace rayfarm
