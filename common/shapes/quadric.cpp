#include "common/shapes/quadric.h"

#include <cmath>
#include <vector>

namespace rayfarm {
namespace {

/// The real roots of a t² + 2 b t + c = 0 in increasing order; at most two. Numerically stable form.
int solve(double a, double b, double c, double roots[2]) {
  if (a == 0) {
    if (b == 0) return 0;
    roots[0] = -c / (2 * b);
    return 1;
  }
  const double discriminant = b * b - a * c;
  if (!(discriminant >= 0)) return 0;
  const double q = -(b + std::copysign(std::sqrt(discriminant), b));
  if (q == 0) {
    roots[0] = 0;
    return 1;
  }
  roots[0] = q / a;
  roots[1] = c / q;
  if (roots[0] > roots[1]) std::swap(roots[0], roots[1]);
  return 2;
}

struct Line {
  Vec3 point, direction;
};

/// The line in which two planes n·x = d meet, if they aren't parallel.
std::optional<Line> meet(const Vec3& n0, double d0, const Vec3& n1, double d1) {
  const Vec3 direction = glm::cross(n0, n1);
  const double length2 = glm::dot(direction, direction);
  if (!(length2 > 1e-24 * glm::dot(n0, n0) * glm::dot(n1, n1))) return std::nullopt;
  return Line{(d0 * glm::cross(n1, direction) + d1 * glm::cross(direction, n0)) / length2, direction};
}

}  // namespace

Quadric make_quadric(const std::array<double, 10>& k, const Vec3& origin) {
  Quadric q;
  q.a = {k[0], k[1], k[2], k[3], k[4], k[5]};
  const Vec3 linear(k[6], k[7], k[8]);
  q.origin = origin;
  const Vec3 ao = q.multiply(origin);
  q.b = ao + linear;
  q.c = glm::dot(origin, ao) + 2 * glm::dot(linear, origin) + k[9];
  return q;
}

Quadric make_cone(const Vec3& base, double base_radius, const Vec3& apex, double apex_radius,
                  std::array<Vec4, 2>& planes) {
  // With x from the middle, h = axis·x and the radius r(h) = r0 + s h: |x|² - h² - (r0 + s h)² = 0.
  Quadric q;
  const Vec3 axis = normalized(apex - base);
  const double length = glm::dot(apex - base, axis);
  const double slope = (apex_radius - base_radius) / length;
  const double r0 = 0.5 * (base_radius + apex_radius);
  q.origin = 0.5 * base + 0.5 * apex;
  const double k = 1 + slope * slope;
  q.a = {1 - k * axis.x * axis.x, 1 - k * axis.y * axis.y, 1 - k * axis.z * axis.z,
         -k * axis.x * axis.y,    -k * axis.x * axis.z,    -k * axis.y * axis.z};
  q.b = -(slope * r0) * axis;
  q.c = -r0 * r0;
  planes[0] = Vec4(axis, glm::dot(axis, apex));
  planes[1] = Vec4(-axis, -glm::dot(axis, base));
  return q;
}

std::optional<double> intersect(const Quadric& quadric, std::span<const Vec4> planes, const Vec3& origin,
                                const Vec3& direction, double t_max) {
  // Start where the line passes the surface's middle: from afar the squares of large coordinates would
  // cancel, and with them the digits that place a small surface.
  const double middle = glm::dot(quadric.origin - origin, direction) / glm::dot(direction, direction);
  const Vec3 o = (origin - quadric.origin) + middle * direction;
  const Vec3 ad = quadric.multiply(direction);
  const double a = glm::dot(direction, ad);
  const double b = glm::dot(o, ad) + glm::dot(quadric.b, direction);
  const double c = glm::dot(o, quadric.multiply(o)) + 2 * glm::dot(quadric.b, o) + quadric.c;
  double roots[2];
  const int count = solve(a, b, c, roots);
  for (int i = 0; i < count; ++i) {
    const double t = middle + roots[i];
    if (!(t > 0 && t <= t_max)) continue;
    const Vec3 p = origin + t * direction;
    bool inside = true;
    for (const Vec4& plane : planes) inside = inside && glm::dot(Vec3(plane), p) <= plane.w;
    if (inside) return t;
  }
  return std::nullopt;
}

std::optional<Box> quadric_bounds(const Quadric& quadric, std::span<const Vec4> planes) {
  // A coordinate's extremes on the cut surface lie where the gradient is a combination of that axis and the
  // normals of at most two active planes (Lagrange). A huge box of extra planes shows what is unbounded: it
  // is touched.
  double scale = 1;
  for (const Vec4& p : planes) {
    const double n = max_magnitude(Vec3(p));
    if (n > 0) scale = std::max(scale, std::abs(p.w) / n);
  }
  double coefficient = 0;
  for (const double v : quadric.a) coefficient = std::max(coefficient, std::abs(v));
  if (coefficient > 0)
    scale = std::max(
        {scale, max_magnitude(quadric.b) / coefficient, std::sqrt(std::abs(quadric.c) / coefficient)});
  scale = std::max(scale, max_magnitude(quadric.origin));
  const double far = 1e4 * scale;

  struct Plane {
    Vec3 n;  // unit length, about the quadric's origin
    double d;
  };
  std::vector<Plane> all;
  for (const Vec4& p : planes) {
    const double length = glm::length(Vec3(p));
    if (!(length > 0)) return std::nullopt;
    all.push_back({Vec3(p) / length, (p.w - glm::dot(Vec3(p), quadric.origin)) / length});
  }
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 n(0);
    n[axis] = 1;
    all.push_back({n, far});
    all.push_back({-n, far});
  }

  Box box;  // about the quadric's origin
  const auto consider = [&](const Vec3& p) {
    const double tolerance = 1e-9 * std::max(max_magnitude(p), 1e-6 * scale);
    for (const Plane& plane : all)
      if (glm::dot(plane.n, p) > plane.d + tolerance) return;
    box.grow(p);
  };
  const auto consider_line = [&](const Line& line) {
    const Vec3 ad = quadric.multiply(line.direction);
    double roots[2];
    const double a = glm::dot(line.direction, ad);
    const double b = glm::dot(line.point, ad) + glm::dot(quadric.b, line.direction);
    const double c =
        glm::dot(line.point, quadric.multiply(line.point)) + 2 * glm::dot(quadric.b, line.point) + quadric.c;
    int count = solve(a, b, c, roots);
    if (count == 0 && a != 0 &&
        b * b - a * c > -1e-12 * (b * b + std::abs(a * c))) {  // touches, but for rounding
      roots[0] = -b / a;
      count = 1;
    }
    for (int i = 0; i < count; ++i) consider(line.point + roots[i] * line.direction);
  };

  const Mat3 matrix(Vec3(quadric.a[0], quadric.a[3], quadric.a[4]),
                    Vec3(quadric.a[3], quadric.a[1], quadric.a[5]),
                    Vec3(quadric.a[4], quadric.a[5], quadric.a[2]));
  for (int axis = 0; axis < 3; ++axis) {
    const int j = (axis + 1) % 3, k = (axis + 2) % 3;
    // No active plane: the gradient's other two components vanish.
    if (auto line = meet(matrix[j], -quadric.b[j], matrix[k], -quadric.b[k])) consider_line(*line);
    // One active plane n: the gradient lies in the span of the axis and n, so it is orthogonal to e × n.
    Vec3 e(0);
    e[axis] = 1;
    for (const Plane& plane : all) {
      const Vec3 tangent = glm::cross(e, plane.n);
      if (auto line = meet(quadric.multiply(tangent), -glm::dot(quadric.b, tangent), plane.n, plane.d))
        consider_line(*line);
    }
  }
  // Two active planes: the line in which they meet.
  for (size_t i = 0; i < all.size(); ++i)
    for (size_t j = i + 1; j < all.size(); ++j)
      if (auto line = meet(all[i].n, all[i].d, all[j].n, all[j].d)) consider_line(*line);

  if (box.is_empty()) return box;
  if (box.magnitude() > 0.5 * far) return std::nullopt;
  const double slack = 1e-9 * std::max(max_component(box.extent()), 1e-3 * box.magnitude());
  return Box{box.lo + quadric.origin - Vec3(slack), box.hi + quadric.origin + Vec3(slack)};
}

}  // namespace rayfarm
