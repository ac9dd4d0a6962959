#pragma once
// Axis-aligned boxes in double precision. An empty box has lo > hi.
#include <array>
#include <limits>

#include "common/math/vector.h"

namespace rayfarm {

struct Box {
  Vec3 lo{std::numeric_limits<double>::infinity()};
  Vec3 hi{-std::numeric_limits<double>::infinity()};

  bool is_empty() const { return !(lo.x <= hi.x && lo.y <= hi.y && lo.z <= hi.z); }
  Vec3 center() const { return 0.5 * lo + 0.5 * hi; }
  Vec3 extent() const { return hi - lo; }
  void grow(const Vec3& p) {
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
  }
  void grow(const Box& b) {
    lo = glm::min(lo, b.lo);
    hi = glm::max(hi, b.hi);
  }
  /// Surface area; 0 for an empty box.
  double area() const {
    if (is_empty()) return 0;
    const Vec3 e = extent();
    return 2 * (e.x * e.y + e.y * e.z + e.z * e.x);
  }
  /// The largest magnitude of a coordinate in the box.
  double magnitude() const { return is_empty() ? 0 : std::max(max_magnitude(lo), max_magnitude(hi)); }
};

inline std::array<Vec3, 8> corners_of(const Box& box) {
  std::array<Vec3, 8> corners;
  for (size_t i = 0; i < 8; ++i)
    corners[i] = {i & 1 ? box.hi.x : box.lo.x, i & 2 ? box.hi.y : box.lo.y, i & 4 ? box.hi.z : box.lo.z};
  return corners;
}

inline Box intersection(const Box& a, const Box& b) {
  return {glm::max(a.lo, b.lo), glm::min(a.hi, b.hi)};
}

}  // namespace rayfarm
