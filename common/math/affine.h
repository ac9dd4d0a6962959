#pragma once
// Affine transforms, named so that neighbours cancel: p_world = world_from_object * p_object.
#include "common/math/box.h"

namespace rayfarm {

struct Affine {
  Mat3 linear{1};
  Vec3 translation{0};

  Vec3 point(const Vec3& p) const { return linear * p + translation; }
  Vec3 vector(const Vec3& v) const { return linear * v; }
  /// A plane's normal goes with the inverse transpose: call this on the *inverse* transform. Not normalised.
  Vec3 normal_by_inverse(const Vec3& n) const { return glm::transpose(linear) * n; }
  bool is_identity() const { return linear == Mat3(1) && translation == Vec3(0); }
};

inline Affine operator*(const Affine& a, const Affine& b) {
  return {a.linear * b.linear, a.linear * b.translation + a.translation};
}

/// The inverse; the determinant must not be zero.
inline Affine inverse(const Affine& a) {
  const Mat3 m = glm::inverse(a.linear);
  return {m, -(m * a.translation)};
}

inline Affine make_translation(const Vec3& t) {
  return {Mat3(1), t};
}
inline Affine make_scale(const Vec3& s) {
  return {Mat3(s.x, 0, 0, 0, s.y, 0, 0, 0, s.z), Vec3(0)};
}
/// Right-handed rotation about the axis (any length > 0) by an angle in degrees.
Affine make_rotation(const Vec3& axis, double degrees);
/// Rotation by the unit quaternion (x, y, z, w).
Affine make_rotation(const Vec4& quaternion);

/// The box of the eight transformed corners.
Box transform(const Affine& a, const Box& box);

}  // namespace rayfarm
