#pragma once
// Where the rays of a pixel pass through it. A sample's place is a function of (seed, frame, pixel, sample)
// alone: counter-based random numbers (Random123; Salmon et al. 2011) leave no state to share between nodes.
#include <array>
#include <cstdint>

#include "common/math/vector.h"
#include "common/scene/render_settings.h"

namespace rayfarm {

/// What a random number is used for, so that no two uses share one.
enum class RandomDimension : uint32_t { screen };

/// Two numbers in [0, 1) for one use by one sample.
std::array<double, 2> random_pair(uint64_t seed, int frame, int x, int y, uint32_t sample,
                                  RandomDimension dimension);

/// The strata of a pixel: columns × rows = samples, as square as the number allows.
struct Strata {
  uint32_t columns = 1, rows = 1;
};
Strata make_strata(uint32_t samples);

/// One of them, as a part of the pixel's unit square.
struct Stratum {
  Vec2 corner{0}, size{1};
};
Stratum stratum_of(const Strata& strata, uint32_t sample);

/// The sample's place inside its pixel, in [0, 1)²: the centre of its stratum (regular) or anywhere in it
/// (jittered).
Vec2 sample_place(const RenderSettings& settings, const Stratum& stratum, int frame, int x, int y,
                  uint32_t sample);

}  // namespace rayfarm
