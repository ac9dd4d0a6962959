#pragma once
// Quadric surfaces cut by planes (thesis 2.3.3): cones and cylinders are quadrics too.
#include <array>
#include <optional>
#include <span>

#include "common/math/box.h"

namespace rayfarm {

/// xᵀA x + 2 b·x + c = 0 with x = p - origin, kept where n·p <= d for each of its planes. The origin lies
/// near the surface, so that coefficients keep their digits far from the world's origin.
struct Quadric {
  Vec3 origin{0};
  std::array<double, 6> a{};  ///< xx yy zz xy xz yz
  Vec3 b{0};
  double c = 0;
  /// The terms at x are not larger in sum than square_bound x² + rest_bound: what their rounding depends on.
  double square_bound = 0, rest_bound = 0;
  uint32_t first_plane = 0;
  uint32_t plane_count = 0;
  uint32_t material = 0;
  uint32_t is_patch = 0;  ///< 1: a bilinear patch, whose (u, v) its planes tell (bilinear_patch.h)
  Box bounds;

  Vec3 multiply(const Vec3& v) const {
    return {a[0] * v.x + a[3] * v.y + a[4] * v.z, a[3] * v.x + a[1] * v.y + a[5] * v.z,
            a[4] * v.x + a[5] * v.y + a[2] * v.z};
  }
  double value(const Vec3& p) const {
    const Vec3 x = p - origin;
    return glm::dot(x, multiply(x)) + 2 * glm::dot(b, x) + c;
  }
  /// Half the gradient: points outward where the equation's sign is negative inside.
  Vec3 gradient(const Vec3& p) const { return multiply(p - origin) + b; }
};

/// What the bounds of its terms are, from a, b and c.
void set_bounds_of_terms(Quadric& quadric);

/// From the ten coefficients (x² y² z² 2xy 2xz 2yz 2x 2y 2z 1) about the world's origin, moved to `origin`.
Quadric make_quadric(const std::array<double, 10>& coefficients, const Vec3& origin);

/// An open cone or cylinder and its two delimiting planes.
Quadric make_cone(const Vec3& base, double base_radius, const Vec3& apex, double apex_radius,
                  std::array<Vec4, 2>& planes);

/// The smallest t in (0, t_max] at which the ray meets the cut surface.
std::optional<double> intersect(const Quadric& quadric, std::span<const Vec4> planes, const Vec3& origin,
                                const Vec3& direction, double t_max);

/// True if no ray hits the surface in the box, wherever hits lie within `error` of it. False may be wrong.
bool passes_by(const Quadric& quadric, const Box& box, double error);

/// The box of the cut surface. Empty optional: the planes do not bound it. An empty box: nothing is left of
/// it.
std::optional<Box> quadric_bounds(const Quadric& quadric, std::span<const Vec4> planes);

}  // namespace rayfarm
