#pragma once
// Rays and hits. The parameter t counts in lengths of the direction, which transforms leave as it is, so t
// means the same in every object's space.
#include <cstdint>
#include <limits>

#include "common/math/index.h"
#include "common/math/vector.h"

namespace rayfarm {

struct Ray {
  Vec3 origin{0};
  Vec3 direction{0, 0, 1};                                 ///< any length > 0
  double t_max = std::numeric_limits<double>::infinity();  ///< hits lie in (0, t_max)
};

/// A primitive of a part: two bits of kind and its index in the scene's array of that kind.
enum class PrimitiveKind : uint32_t { triangle, sphere, polygon, quadric };
struct PrimitiveId {
  uint32_t bits = 0;
  PrimitiveKind kind() const { return static_cast<PrimitiveKind>(bits >> 30); }
  uint32_t index() const { return bits & 0x3fffffffu; }
  bool operator==(const PrimitiveId&) const = default;
};
constexpr PrimitiveId make_primitive_id(PrimitiveKind kind, uint32_t index) {
  return {static_cast<uint32_t>(kind) << 30 | index};
}

inline constexpr PrimitiveId kNoPrimitive{kNone};

/// The closest hit. Among hits at the same t the smallest (instance, primitive) wins, so that the answer does
/// not depend on the order in which a hierarchy is visited.
struct Hit {
  double t = std::numeric_limits<double>::infinity();
  uint32_t instance = kNone;
  PrimitiveId primitive;
  uint32_t block_lane =
      kNone;  ///< 8 × block + lane, where the vertices stand, if it was tested as a triangle
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
