#include "common/sampling/warps.h"

#include <numbers>

#include "common/math/portable_math.h"

namespace rayfarm {

using std::numbers::pi;

Vec2 sample_disk(const Vec2& u) {
  const Vec2 p = 2.0 * u - Vec2(1);
  if (p.x == 0 && p.y == 0) return Vec2(0);
  double r, phi;
  if (std::abs(p.x) > std::abs(p.y)) {
    r = p.x;
    phi = pi / 4 * (p.y / p.x);
  } else {
    r = p.y;
    phi = pi / 2 - pi / 4 * (p.x / p.y);
  }
  const auto [sine, cosine] = portable_sine_cosine(phi);
  return r * Vec2(cosine, sine);
}

Vec3 sample_cosine(const Vec2& u) {
  const Vec2 d = sample_disk(u);
  return {d.x, d.y, std::sqrt(std::max(0.0, 1 - d.x * d.x - d.y * d.y))};
}
double cosine_pdf(double cosine) {
  return std::max(0.0, cosine) / pi;
}

namespace {
/// The direction of a polar angle and a part of the whole turn.
Vec3 spherical(double sine, double cosine, double turn) {
  const SineCosine azimuth = portable_sine_cosine(2 * pi * turn);
  return {sine * azimuth.cosine, sine * azimuth.sine, cosine};
}
Vec3 spherical(double cosine, double turn) {
  return spherical(std::sqrt(std::max(0.0, 1 - cosine * cosine)), cosine, turn);
}
}  // namespace

Vec3 sample_phong(const Vec2& u, double exponent) {
  return spherical(portable_pow(1 - u.x, 1 / (exponent + 1)), u.y);
}
double phong_pdf(double cosine, double exponent) {
  return cosine > 0 ? (exponent + 1) / (2 * pi) * portable_pow(cosine, exponent) : 0;
}

Vec3 sample_sphere(const Vec2& u) {
  return spherical(1 - 2 * u.x, u.y);
}

Vec3 sample_cone(const Vec2& u, double one_minus_cosine) {
  const double height = one_minus_cosine * u.x;  // 1 - cos keeps its digits in narrow cones
  return spherical(std::sqrt(height * (2 - height)), 1 - height, u.y);
}
double cone_pdf(double one_minus_cosine) {
  return 1 / (2 * pi * one_minus_cosine);
}

Vec3 sample_henyey_greenstein(const Vec2& u, double g) {
  if (std::abs(g) < 1e-6) return sample_sphere(u);  // where the quotient below would lose its digits
  const double inner = (1 - g * g) / (1 - g + 2 * g * u.x);
  return spherical(std::clamp((1 + g * g - inner * inner) / (2 * g), -1.0, 1.0), u.y);
}
double henyey_greenstein_pdf(double cosine, double g) {
  const double square = 1 + g * g - 2 * g * cosine;
  return (1 - g * g) / (4 * pi * square * std::sqrt(square));
}

Vec2 sample_triangle(const Vec2& u) {
  const double root = std::sqrt(1 - u.x);
  return {(1 - u.y) * root, u.y * root};
}

Frame::Frame(const Vec3& n) : normal(n) {
  const double sign = std::copysign(1.0, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
  tangent = {1 + sign * n.x * n.x * a, sign * b, -sign * n.x};
  bitangent = {b, sign + n.y * n.y * a, -n.y};
}

}  // namespace rayfarm
