#include "host/experiments/colour/colour_difference.h"

#include <cmath>
#include <numbers>

namespace rayfarm {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

double root_of_share(double chroma) {  // the square root of c^7 / (c^7 + 25^7)
  const double c7 = std::pow(chroma, 7);
  return std::sqrt(c7 / (c7 + std::pow(25.0, 7)));
}

/// In degrees, from 0 to 360; 0 of grey.
double hue_of(double a, double b) {
  if (a == 0 && b == 0) return 0;
  const double hue = std::atan2(b, a) / kDegree;
  return hue < 0 ? hue + 360 : hue;
}

}  // namespace

Vec3 lab_of(const Color& rgb) {
  // IEC 61966-2-1, by rows; their sums are the white.
  const Vec3 x(0.4124, 0.3576, 0.1805), y(0.2126, 0.7152, 0.0722), z(0.0193, 0.1192, 0.9505);
  const auto compressed = [&rgb](const Vec3& row) {
    const double t = glm::dot(row, rgb) / (row.x + row.y + row.z);
    constexpr double kKnee = 6.0 / 29;
    return t > kKnee * kKnee * kKnee ? std::cbrt(t) : t / (3 * kKnee * kKnee) + 4.0 / 29;
  };
  const double fx = compressed(x), fy = compressed(y), fz = compressed(z);
  return {116 * fy - 16, 500 * (fx - fy), 200 * (fy - fz)};
}

double ciede2000(const Vec3& first, const Vec3& second) {
  const double mean_chroma = 0.5 * (std::hypot(first.y, first.z) + std::hypot(second.y, second.z));
  const double stretch = 1 + 0.5 * (1 - root_of_share(mean_chroma));
  const double a1 = stretch * first.y, a2 = stretch * second.y;
  const double c1 = std::hypot(a1, first.z), c2 = std::hypot(a2, second.z);
  const double h1 = hue_of(a1, first.z), h2 = hue_of(a2, second.z);

  const double lightness = second.x - first.x, chroma = c2 - c1;
  double turn = 0, hue = h1 + h2;  // of a grey the hue is the other's
  if (c1 * c2 != 0) {
    turn = h2 - h1;
    const bool is_far = std::abs(turn) > 180;
    if (is_far) turn += turn > 0 ? -360 : 360;
    hue = is_far ? (hue < 360 ? hue + 360 : hue - 360) / 2 : hue / 2;
  }
  const double across = 2 * std::sqrt(c1 * c2) * std::sin(0.5 * turn * kDegree);

  const double l = 0.5 * (first.x + second.x), c = 0.5 * (c1 + c2);
  const double t = 1 - 0.17 * std::cos((hue - 30) * kDegree) + 0.24 * std::cos(2 * hue * kDegree) +
                   0.32 * std::cos((3 * hue + 6) * kDegree) - 0.20 * std::cos((4 * hue - 63) * kDegree);
  const double from_blue = (hue - 275) / 25;
  const double rotation = -std::sin(60 * std::exp(-from_blue * from_blue) * kDegree) * 2 * root_of_share(c);
  const double from_middle = (l - 50) * (l - 50);
  const double dl = lightness / (1 + 0.015 * from_middle / std::sqrt(20 + from_middle)),
               dc = chroma / (1 + 0.045 * c), dh = across / (1 + 0.015 * c * t);
  return std::sqrt(dl * dl + dc * dc + dh * dh + rotation * dc * dh);
}

}  // namespace rayfarm
