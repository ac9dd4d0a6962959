#include "common/shapes/bilinear_patch.h"

namespace rayfarm {
namespace {

/// b, c and d of p = a + u b + v c + u v d.
struct Directions {
  explicit Directions(const PatchCorners& p)
      : b(p[1] - p[0]), c(p[3] - p[0]), d((p[0] - p[1]) + (p[2] - p[3])) {}
  double volume() const { return glm::dot(glm::cross(b, c), d); }
  Vec3 b, c, d;
};

}  // namespace

bool is_planar(const PatchCorners& corners) {
  constexpr double kLeastHeight = 1e-6;
  const Directions of(corners);
  const double size = std::max({max_magnitude(of.b), max_magnitude(of.c), max_magnitude(of.d)});
  return !(std::abs(of.volume()) > kLeastHeight * size * size * size);
}

Quadric make_patch(const PatchCorners& corners, std::array<Vec4, 4>& planes) {
  const Directions of(corners);
  // Rows of the inverse of (b c d), times the volume: their products with p - a are x, y and z times the
  // volume.
  const double volume = of.volume();
  const Vec3 x = glm::cross(of.c, of.d), y = glm::cross(of.d, of.b), z = glm::cross(of.b, of.c);
  // -sign(volume) (x y - volume z) = 0, about the middle; its gradient is along dp/du × dp/dv.
  const double scale = -std::copysign(1 / (glm::length(x) * glm::length(y)), volume);
  Quadric q;
  q.origin = 0.25 * ((corners[0] + corners[1]) + (corners[2] + corners[3]));
  const Vec3 middle = q.origin - corners[0];
  const double x0 = glm::dot(x, middle), y0 = glm::dot(y, middle), z0 = glm::dot(z, middle);
  q.a = {scale * x.x * y.x,
         scale * x.y * y.y,
         scale * x.z * y.z,
         scale * 0.5 * (x.x * y.y + x.y * y.x),
         scale * 0.5 * (x.x * y.z + x.z * y.x),
         scale * 0.5 * (x.y * y.z + x.z * y.y)};
  q.b = scale * 0.5 * (y0 * x + x0 * y - volume * z);
  q.c = scale * (x0 * y0 - volume * z0);
  set_bounds_of_terms(q);
  const auto bound = [&](const Vec3& gradient, Vec4& least, Vec4& most) {
    const double length = glm::length(gradient);
    const Vec3 n = std::copysign(1 / length, volume) * gradient;
    const double begin = glm::dot(n, corners[0]);
    least = Vec4(-n, -begin);
    most = Vec4(n, begin + std::abs(volume) / length);
  };
  bound(x, planes[0], planes[1]);
  bound(y, planes[2], planes[3]);
  q.is_patch = 1;
  for (const Vec3& corner : corners) q.bounds.grow(corner);  // between them it is their mean
  const double rounding = 0x1p-40 * (q.bounds.magnitude() + max_magnitude(q.bounds.extent()));
  q.bounds.lo -= Vec3(rounding);
  q.bounds.hi += Vec3(rounding);
  return q;
}

Vec2 patch_parameters(std::span<const Vec4> planes, const Vec3& p) {
  const auto between = [&p](const Vec4& least, const Vec4& most) {
    return (least.w - glm::dot(Vec3(least), p)) / (least.w + most.w);
  };
  return {between(planes[0], planes[1]), between(planes[2], planes[3])};
}

}  // namespace rayfarm
