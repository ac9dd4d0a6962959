#pragma once
// The thesis's distribution of secondary diffuse rays (section 3.3): bands about the normal, each ray with
// the same share of the light that Lambert's cosine law lets through.
#include <cstdint>
#include <span>
#include <vector>

#include "common/math/vector.h"

namespace rayfarm {

class DiffuseDirections {
 public:
  /// Any number of rays; 25 are one along the normal and four bands of six (Figure 3.1).
  explicit DiffuseDirections(uint32_t rays);

  /// Unit vectors about +y. Rays of a band stand one after the other.
  std::span<const Vec3> about_y() const { return directions_; }

 private:
  std::vector<Vec3> directions_;
};

/// Rotates a direction about +y to one about `normal`, after a turn about +y by `radians`.
Vec3 rotated_to(const Vec3& normal, const Vec3& about_y, double radians);

}  // namespace rayfarm
