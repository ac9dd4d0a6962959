#include "common/scene/goniometry.h"

#include <numbers>

#include "common/math/portable_math.h"

namespace rayfarm {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

/// Where `x` stands among rising numbers: between `below` and the next.
struct Between {
  size_t below = 0;
  double part = 0;
};
Between find(std::span<const double> rising, double x) {
  if (rising.size() < 2 || x <= rising.front()) return {};
  size_t i = static_cast<size_t>(std::upper_bound(rising.begin(), rising.end(), x) - rising.begin()) - 1;
  i = std::min(i, rising.size() - 2);
  return {i, std::min(1.0, (x - rising[i]) / (rising[i + 1] - rising[i]))};
}

}  // namespace

double eval_intensity(const GoniometricDiagram& diagram, std::span<const double> values, const Vec3& axis,
                      const Vec3& zero, const Vec3& direction) {
  values = values.subspan(diagram.first_value, values_of(diagram.vertical_count, diagram.horizontal_count));
  const auto vertical = values.first(diagram.vertical_count);
  const auto horizontal = values.subspan(diagram.vertical_count, diagram.horizontal_count);
  const auto table = values.subspan(diagram.vertical_count + diagram.horizontal_count);
  const double theta = kDegrees * portable_acos(glm::dot(axis, direction));
  if (theta < vertical.front() - 1e-9 || theta > vertical.back() + 1e-9) return 0;
  const double x = glm::dot(zero, direction), y = glm::dot(glm::cross(axis, zero), direction);
  const double r = std::sqrt(x * x + y * y);
  double phi = r > 0 ? kDegrees * portable_acos(x / r) : 0;  // in [0, 180]
  if (y < 0) phi = 360 - phi;
  const double last = horizontal.back();
  if (last <= 180 && phi > 180) phi = 360 - phi;
  if (last <= 90 && phi > 90) phi = 180 - phi;
  const Between v = find(vertical, theta), h = find(horizontal, phi);
  const auto at = [&](size_t column, size_t row) {
    return table[std::min(column, horizontal.size() - 1) * vertical.size() +
                 std::min(row, vertical.size() - 1)];
  };
  return (1 - h.part) * ((1 - v.part) * at(h.below, v.below) + v.part * at(h.below, v.below + 1)) +
         h.part * ((1 - v.part) * at(h.below + 1, v.below) + v.part * at(h.below + 1, v.below + 1));
}

}  // namespace rayfarm
