#pragma once
// What a ray meets.
#include "common/math/ray.h"
#include "common/shapes/primitive_id.h"

namespace rayfarm {

/// The closest hit. Among hits at the same t the smallest (instance, primitive) wins, so that the answer does
/// not depend on the order in which a hierarchy is visited.
struct Hit {
  double t = std::numeric_limits<double>::infinity();
  uint32_t instance = kNone;
  PrimitiveId primitive;
  /// 8 × block + lane, where the vertices stand, if it was tested as a triangle.
  uint32_t block_lane = kNone;
  double u = 0, v = 0, w = 0;  ///< then: barycentric weights of the three vertices

  bool is_hit() const { return instance != kNone; }
  /// True if a hit at (t, instance, primitive) comes before this one.
  bool is_beaten_by(double other_t, uint32_t other_instance, PrimitiveId other) const {
    if (other_t != t) return other_t < t;
    if (other_instance != instance) return other_instance < instance;
    return other.bits < primitive.bits;
  }
};

}  // namespace rayfarm
