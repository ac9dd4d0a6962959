#pragma once
// Sample points on the unit square (Shirley, Sung and Brown 1991, section 2.2.1), one pattern for each pair
// of dimensions: screen, lens, and what happens at each bounce. The pairs of one sample are linked at random,
// which Cook calls uncorrelated jittering. A point is a function of (seed, frame, pixel, sample, dimension)
// alone.
#include <cstdint>
#include <vector>

#include "common/math/vector.h"
#include "common/sampling/random.h"

namespace rayfarm {

enum class SamplingPattern : uint8_t { sobol, regular, jittered, uncorrelated, n_rooks, poisson, corners };

struct SamplerSettings {
  SamplingPattern pattern = SamplingPattern::sobol;
  uint32_t samples = 1;  ///< per pixel
  uint64_t seed = 0;
};

/// Rows and columns of a pixel's strata: columns × rows = samples, as square as the number allows.
struct Strata {
  uint32_t columns = 1, rows = 1;
};
Strata make_strata(uint32_t samples);

/// From its last to its first.
uint32_t reversed_bits(uint32_t x);

class Sampler {
 public:
  Sampler(const SamplerSettings& settings, int frame);

  /// The sample's point in [0, 1)². In the pattern's own order on the screen; in other dimensions the order
  /// of the cells is random.
  Vec2 point(const SampleId& id, uint32_t dimension) const;

  /// The numbers of the i-th of `count` rays that a sample sends in place of one: those of Sobol's sequence
  /// go on among the samples' own, as if there were so many more samples; in other patterns they are of a
  /// pixel far away.
  SampleId split(const SampleId& id, uint32_t i, uint32_t count) const {
    if (is_sobol()) return {id.x, id.y, id.sample * count + i};
    return {id.x, id.y ^ static_cast<int>(i << kSplitShift), id.sample};
  }

  int frame() const { return frame_; }

  // What points of several samples at once are made of (sobol-inl.h), where the pattern is Sobol's.
  bool is_sobol() const { return pattern_ == SamplingPattern::sobol || pattern_ == SamplingPattern::corners; }
  /// Common to all dimensions of a pixel's samples.
  uint64_t pixel_key(const SampleId& id) const {
    return mix_bits((uint64_t{static_cast<uint32_t>(id.x)} << 32 | static_cast<uint32_t>(id.y)) ^ seed_bits_);
  }
  uint64_t frame_and_dimension(uint32_t dimension) const {
    return uint64_t{static_cast<uint32_t>(frame_)} << 32 | dimension;
  }

  /// The most samples that Poisson disks can be laid out for.
  static constexpr uint32_t kMostPoissonSamples = 1024;

 private:
  static constexpr uint32_t kSplitShift = 20;  ///< pictures have fewer rows

  SamplingPattern pattern_;
  uint32_t samples_;
  uint64_t seed_, seed_bits_;
  int frame_;
  Strata strata_;
  std::vector<Vec2> poisson_;
};

}  // namespace rayfarm
