#include "common/lighting/zones/zone_directions.h"

#include <numbers>

#include "common/math/portable_math.h"
#include "common/sampling/warps.h"

namespace rayfarm {

using std::numbers::pi;

uint32_t direction_cells_for(double exponent) {
  const double width = 0.5 * portable_acos(portable_pow(0.5, 1 / std::max(exponent, 1e-3)));
  const double cells = std::ceil(2 / width);
  return cells > kMostDirectionCells ? 0 : std::max(2u, static_cast<uint32_t>(cells));
}

Vec2 direction_place(const Vec3& local) {
  // sample_disk backwards: which of the square's four triangles the point is in tells the larger coordinate.
  const double x = local.x, y = local.y, r = std::sqrt(x * x + y * y);
  if (!(r > 0)) return Vec2(0.5);
  Vec2 p;
  if (std::abs(x) > std::abs(y)) {
    const double angle = std::copysign(portable_acos(std::abs(x) / r), x * y);
    p = {std::copysign(r, x), std::copysign(r, x) * angle * 4 / pi};
  } else {
    const double angle = std::copysign(portable_acos(std::abs(y) / r), x * y);
    p = {std::copysign(r, y) * angle * 4 / pi, std::copysign(r, y)};
  }
  return glm::clamp(0.5 * (p + Vec2(1)), Vec2(0), Vec2(1));
}

Vec3 direction_at(const Vec2& place) {
  return sample_cosine(place);
}

}  // namespace rayfarm
