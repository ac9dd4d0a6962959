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

/// Rays traced.
struct RayCounts {
  std::array<uint64_t, kRayKinds> by_kind{};  ///< in the order of RayKind

  uint64_t& operator[](RayKind kind) { return by_kind[static_cast<size_t>(kind)]; }
  uint64_t operator[](RayKind kind) const { return by_kind[static_cast<size_t>(kind)]; }
  uint64_t total() const { return std::accumulate(by_kind.begin(), by_kind.end(), uint64_t{0}); }
  RayCounts& operator+=(const RayCounts& other) {
    for (size_t kind = 0; kind < kRayKinds; ++kind) by_kind[kind] += other.by_kind[kind];
    return *this;
  }
  bool operator==(const RayCounts&) const = default;
};

}  // namespace rayfarm
