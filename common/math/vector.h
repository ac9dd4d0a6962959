#pragma once
// The vector types of the renderer. Geometry is double precision: float appears only in stored mesh vertices
// and in the conservative boxes of the hierarchy.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

namespace rayfarm {

using Vec2 = glm::dvec2;
using Vec3 = glm::dvec3;
using Vec4 = glm::dvec4;
using Mat3 = glm::dmat3;
/// A colour: linear Rec.709 red, green, blue.
using Color = glm::dvec3;

inline bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
inline double max_component(const Vec3& v) {
  return std::max(v.x, std::max(v.y, v.z));
}
inline double max_magnitude(const Vec3& v) {
  return max_component(glm::abs(v));
}
/// 0, 1 or 2: the axis along which a plane of this normal is seen best.
inline uint32_t largest_axis(const Vec3& v) {
  const Vec3 m = glm::abs(v);
  return m.x > m.y ? (m.x > m.z ? 0 : 2) : (m.y > m.z ? 1 : 2);
}

/// 0 below `low`, 1 above `high`, a cubic without a kink between.
inline double smooth_step(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

/// The direction of `v`, safe for lengths whose square would under- or overflow. Zero stays zero.
inline Vec3 normalized(const Vec3& v) {
  const double square = glm::dot(v, v);
  if (square > 1e-280 && square < 1e280) return v * (1 / std::sqrt(square));
  const double scale = max_magnitude(v);
  if (!(scale > 0)) return Vec3(0);
  const Vec3 scaled = v / scale;
  return scaled / std::sqrt(glm::dot(scaled, scaled));
}

}  // namespace rayfarm
