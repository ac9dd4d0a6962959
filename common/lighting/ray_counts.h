#pragma once
// The kinds of rays, and how many of each were traced.
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>

namespace rayfarm {

enum class RayKind : uint8_t { primary, shadow, reflected, transmitted, diffuse };

/// Of each kind, in the order of RayKind; reports and statistics call them so.
inline constexpr std::array kRayKindNames{"primary", "shadow", "reflected", "transmitted", "diffuse"};
inline constexpr size_t kRayKinds = kRayKindNames.size();

/// What else is counted of rays.
enum class RayTally : uint8_t {
  tree_depth,    ///< of the trees that eye rays grew, summed up; an eye ray alone is one deep
  cut,           ///< rays that were not traced because they would contribute less than is asked for
  eye_items,     ///< eye rays that hit what the item buffer told to test first
  shadow_items,  ///< shadow rays that the item buffer of their light ended
  compared,  ///< eye rays that were searched in the ordinary way, too, to see whether that makes a difference
  differing  ///< those for which the item buffer gave another primitive
};
inline constexpr size_t kRayTallies = 6;

/// Rays traced.
struct RayCounts {
  std::array<uint64_t, kRayKinds> by_kind{};    ///< in the order of RayKind
  std::array<uint64_t, kRayTallies> tallies{};  ///< in the order of RayTally

  uint64_t& operator[](RayKind kind) { return by_kind[static_cast<size_t>(kind)]; }
  uint64_t operator[](RayKind kind) const { return by_kind[static_cast<size_t>(kind)]; }
  uint64_t& operator[](RayTally tally) { return tallies[static_cast<size_t>(tally)]; }
  uint64_t operator[](RayTally tally) const { return tallies[static_cast<size_t>(tally)]; }
  uint64_t total() const { return std::accumulate(by_kind.begin(), by_kind.end(), uint64_t{0}); }
  /// How deep the trees of rays are (Weghorst, Hooper and Greenberg 1984, section 4: "the average depth of
  /// the ray-intersection tree is not much greater than one").
  double average_depth() const {
    const uint64_t trees = (*this)[RayKind::primary];
    return trees > 0 ? static_cast<double>((*this)[RayTally::tree_depth]) / static_cast<double>(trees) : 0;
  }
  RayCounts& operator+=(const RayCounts& other) {
    for (size_t kind = 0; kind < kRayKinds; ++kind) by_kind[kind] += other.by_kind[kind];
    for (size_t tally = 0; tally < kRayTallies; ++tally) tallies[tally] += other.tallies[tally];
    return *this;
  }
  bool operator==(const RayCounts&) const = default;
};

}  // namespace rayfarm
