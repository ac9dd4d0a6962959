#include "common/lighting/diffuse_directions.h"

#include <numbers>

#include "common/math/portable_math.h"
#include "common/sampling/warps.h"

namespace rayfarm {

DiffuseDirections::DiffuseDirections(uint32_t rays) {
  // Six a band up to about 36 rays; then bands grow with their number, to stay as wide as they are high.
  const auto per_band =
      std::max(6u, static_cast<uint32_t>(std::lround(1.2 * std::sqrt(static_cast<double>(rays)))));
  uint32_t band = 0;
  for (uint32_t done = 0; done < rays; ++band) {
    const uint32_t count = done == 0 ? 1 : std::min(per_band, rays - done);
    // sin² of the angle to the normal is the share of the light inside it: the middle of the band's.
    const double sine2 = done == 0 ? 0 : (done + 0.5 * count) / rays;
    const double sine = std::sqrt(sine2), cosine = std::sqrt(1 - sine2);
    for (uint32_t i = 0; i < count; ++i) {
      // Every second band is turned by half a step, so that no two rays stand above each other.
      const double phi = 2 * std::numbers::pi * (i + 0.5 * (band % 2)) / count;
      directions_.emplace_back(sine * portable_cos(phi), cosine, sine * portable_sin(phi));
    }
    done += count;
  }
}

Vec3 rotated_to(const Vec3& normal, const Vec3& about_y, double radians) {
  const double c = portable_cos(radians), s = portable_sin(radians);
  return Frame(normal).to_world({c * about_y.x - s * about_y.z, s * about_y.x + c * about_y.z, about_y.y});
}

}  // namespace rayfarm
