#include "common/lighting/zones/hemicube.h"

#include <numbers>

namespace rayfarm {

HemicubePixel Hemicube::operator[](uint64_t pixel) const {
  const double n = cells_, rows = rows_;
  const auto column = static_cast<double>(pixel % cells_), row = static_cast<double>(pixel / cells_);
  const double along = (2 * column + 1) / n - 1;
  Vec3 p(along, (2 * row + 1) / n - 1, 1);
  double area = 4 / (n * n);
  if (row >= n) {
    const uint64_t of_sides = pixel / cells_ - cells_, side = of_sides / rows_;
    p = {1, along, (static_cast<double>(of_sides % rows_) + 0.5) / rows};
    for (uint64_t i = 0; i < side; ++i) p = {-p.y, p.x, p.z};
    area = 2 / (n * rows);
  }
  // The cosines at the zone's middle and at the pixel over the square of the distance; on the top p.z is 1.
  const double distance2 = glm::dot(p, p);
  const double form_factor = p.z * area / (std::numbers::pi * distance2 * distance2);
  return {normalized(p), static_cast<uint64_t>(std::floor(form_factor * 0x1p40 + 0.5))};
}

}  // namespace rayfarm
