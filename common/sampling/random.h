#pragma once
// Counter-based random numbers (Random123; Salmon et al. 2011): a number is a function of its purpose alone,
// so there is no state to share between nodes.
#include <array>
#include <cstdint>

namespace rayfarm {

/// Which sample of which pixel.
struct SampleId {
  int x = 0, y = 0;
  uint32_t sample = 0;
};

/// What a pair of sample numbers is used for, so that no two uses share one. A bounce has four pairs.
namespace dimension {
inline constexpr uint32_t kScreen = 0, kLens = 1, kPattern = 2, kTime = 3, kFirstBounce = 4;
enum Bounce : uint32_t { kDirection, kLobe, kLight, kLightPoint };
/// Walks through media: of a path's ray, and of the shadow ray that goes out at its end.
enum Walk : uint32_t { kFree, kShadow };
/// Which part of a mix a ray meets; bounces begin at depth 1. `stream`: as of other uses within a sample.
constexpr uint32_t of_mix(uint32_t stream) {
  return stream << 8 | kFirstBounce;
}
constexpr uint32_t of_bounce(uint32_t depth, Bounce use) {
  return kFirstBounce + 4 * depth + use;
}
constexpr uint32_t of_walk(uint32_t depth, Walk use) {
  return 1u << 31 | depth << 1 | use;
}
}  // namespace dimension

/// Two numbers in [0, 1).
std::array<double, 2> random_pair(uint64_t seed, int frame, const SampleId& id, uint32_t dimension);

/// 64 bits that look random for any input (the finaliser of SplitMix64; Steele, Lea, Flood 2014).
constexpr uint64_t mix_bits(uint64_t x) {
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ x >> 27) * 0x94d049bb133111ebull;
  return x ^ x >> 31;
}

/// The place of `i` in a random order of [0, n): a bijection for every seed.
uint32_t permuted(uint32_t i, uint32_t n, uint64_t seed);

}  // namespace rayfarm
