#include "common/shapes/quadric.h"

#include <cmath>
#include <vector>

#include "common/math/double_double.h"

namespace rayfarm {
namespace {

/// The real roots of a t² + 2 b t + c = 0 in increasing order; at most two. Numerically stable form.
int solve(double a, double b, double c, double roots[2], double& discriminant) {
  discriminant = b * b - a * c;
  if (a == 0) {
    if (b == 0) return 0;
    roots[0] = -c / (2 * b);
    return 1;
  }
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

/// The equation at `p` without cancellation.
double exact_value(const Quadric& q, const Vec3& p) {
  const DoubleDouble x = DoubleDouble::sum(p.x, -q.origin.x), y = DoubleDouble::sum(p.y, -q.origin.y),
                     z = DoubleDouble::sum(p.z, -q.origin.z);
  const auto& a = q.a;
  const DoubleDouble gx = x * a[0] + y * a[3] + z * a[4] + 2 * q.b.x,
                     gy = x * a[3] + y * a[1] + z * a[5] + 2 * q.b.y,
                     gz = x * a[4] + y * a[5] + z * a[2] + 2 * q.b.z;
  return (x * gx + y * gy + z * gz + q.c).high;
}

/// Moves a root of the ray's equation as close to the surface as rounding_bound() promises; false if the ray
/// passes the surface by. Where a surface is long and thin the terms are far larger than their sum, and the
/// root needs more digits. Rarely called: kept out of the loop that asks for it.
[[gnu::noinline]] bool refine(const Quadric& q, const Vec3& origin, const Vec3& direction, double& t) {
  constexpr double kTolerance = 0x1p-46;  // half of rounding_bound's
  constexpr int kMostSteps = 4;
  for (int step = 0;; ++step) {
    const Vec3 p = origin + t * direction, gradient = q.gradient(p);
    const double off = exact_value(q, p);
    const double tolerance = 2 * kTolerance * std::max(max_magnitude(p), max_magnitude(origin));
    if (off * off <= tolerance * tolerance * glm::dot(gradient, gradient)) return true;
    if (step == kMostSteps) return false;
    // The same equation about p; where rounding alone made it a hit, the place where the ray comes closest.
    const double a = glm::dot(direction, q.multiply(direction)), b = glm::dot(gradient, direction);
    const double discriminant = b * b - a * off;
    if (discriminant >= 0 && b != 0)
      t -= off / (b + std::copysign(std::sqrt(discriminant), b));
    else if (a != 0)
      t -= b / a;
  }
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

void set_bounds_of_terms(Quadric& q) {
  double largest = 0;
  for (const double v : q.a) largest = std::max(largest, std::abs(v));
  // 2 b·x is at most x² + b², for any unit of length.
  q.square_bound = 4 * largest;
  q.rest_bound = std::abs(q.c) + (largest > 0 ? glm::dot(q.b, q.b) / largest : 0);
}

Quadric make_quadric(const std::array<double, 10>& k, const Vec3& origin) {
  Quadric q;
  q.a = {k[0], k[1], k[2], k[3], k[4], k[5]};
  const Vec3 linear(k[6], k[7], k[8]);
  q.origin = origin;
  const Vec3 ao = q.multiply(origin);
  q.b = ao + linear;
  q.c = glm::dot(origin, ao) + 2 * glm::dot(linear, origin) + k[9];
  set_bounds_of_terms(q);
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
  set_bounds_of_terms(q);
  planes[0] = Vec4(axis, glm::dot(axis, apex));
  planes[1] = Vec4(-axis, -glm::dot(axis, base));
  return q;
}

std::optional<double> intersect(const Quadric& quadric, std::span<const Vec4> planes, const Vec3& origin,
                                const Vec3& direction, double t_max) {
  // Start where the line passes the surface's middle: from afar the squares of large coordinates would
  // cancel, and with them the digits that place a small surface.
  const double direction2 = glm::dot(direction, direction);
  const double middle = glm::dot(quadric.origin - origin, direction) / direction2;
  const Vec3 o = (origin - quadric.origin) + middle * direction;
  const Vec3 ad = quadric.multiply(direction);
  const double a = glm::dot(direction, ad);
  const double b = glm::dot(o, ad) + glm::dot(quadric.b, direction);
  const double c = glm::dot(o, quadric.multiply(o)) + 2 * glm::dot(quadric.b, o) + quadric.c;
  double roots[2], discriminant;
  const int count = solve(a, b, c, roots, discriminant);
  const auto is_kept = [&](double t) {
    if (!(t > 0)) return false;
    const Vec3 p = origin + t * direction;
    bool is_inside = true;
    for (const Vec4& plane : planes) is_inside = is_inside && glm::dot(Vec3(plane), p) <= plane.w;
    return is_inside;
  };
  for (int i = 0; i < count; ++i) {
    double t = middle + roots[i];
    if (!is_kept(t)) continue;
    // The gradient is no shorter than the discriminant tells, so the hit is no farther off the surface than
    // the terms' rounding over it.
    constexpr double kMostTerms = 8;
    const double terms =
        quadric.square_bound * (glm::dot(o, o) + roots[i] * roots[i] * direction2) + quadric.rest_bound;
    const double most = kMostTerms * (max_magnitude(origin) + t * max_magnitude(direction));
    const bool is_exact = terms * terms * direction2 <= most * most * discriminant;
    if (!is_exact && !(refine(quadric, origin, direction, t) && is_kept(t))) continue;
    // Not before: a root beyond t_max may be moved to it, and a search as far as a hit has to find it again.
    if (t <= t_max) return t;
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
    double discriminant;
    int count = solve(a, b, c, roots, discriminant);
    if (count == 0 && a != 0 &&
        discriminant > -1e-12 * (b * b + std::abs(a * c))) {  // touches, but for rounding
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

bool passes_by(const Quadric& quadric, const Box& box, double error) {
  // The equation about the box's centre, each term as large as it gets.
  constexpr double kRounding = 1e-14;
  const Vec3 center = box.center(), h = 0.5 * box.extent() + Vec3(error), x = center - quadric.origin;
  const Vec3 gradient = glm::abs(quadric.gradient(center));
  const auto& a = quadric.a;
  const Vec3 turn(std::abs(a[0]) * h.x + std::abs(a[3]) * h.y + std::abs(a[4]) * h.z,
                  std::abs(a[3]) * h.x + std::abs(a[1]) * h.y + std::abs(a[5]) * h.z,
                  std::abs(a[4]) * h.x + std::abs(a[5]) * h.y + std::abs(a[2]) * h.z);
  const double change = 2 * glm::dot(gradient, h) + glm::dot(turn, h) +
                        kRounding * (quadric.square_bound * glm::dot(x, x) + quadric.rest_bound);
  return std::abs(quadric.value(center)) > change;
}

}  // namespace rayfarm
