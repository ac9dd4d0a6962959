#pragma once
// Goniometric diagrams: how the intensity of a light differs from direction to direction.
#include <cstdint>
#include <span>

#include "common/math/vector.h"

namespace rayfarm {

/// A table of type C: vertical angles from the light's direction, horizontal angles about it, both rising, in
/// degrees; then intensities, all vertical angles of one horizontal angle after the other. Horizontal angles
/// end at 0, 90, 180 or 360: the rest follows by symmetry.
struct GoniometricDiagram {
  uint32_t first_value = 0;  ///< in goniometric_values
  uint32_t vertical_count = 0, horizontal_count = 0;
};
constexpr size_t values_of(size_t vertical, size_t horizontal) {
  return vertical + horizontal + vertical * horizontal;
}

/// The intensity in a direction, bilinear between the table's; 0 beyond its vertical angles. `axis` and
/// `zero` are unit and perpendicular: the light's direction, and where the horizontal angle is 0.
double eval_intensity(const GoniometricDiagram& diagram, std::span<const double> values, const Vec3& axis,
                      const Vec3& zero, const Vec3& direction);

}  // namespace rayfarm
