#include "common/lighting/diffuse_directions.h"

#include <numbers>

#include "common/math/portable_math.h"

namespace rayfarm {

DiffuseDirections::DiffuseDirections(uint64_t rays, DiffuseBands bands)
    // Six a band up to about 36 rays; then bands grow with their number, to stay as wide as they are high.
    : rays_(rays),
      per_band_(
          std::max<size_t>(6, static_cast<size_t>(std::lround(1.2 * std::sqrt(static_cast<double>(rays)))))),
      bands_(bands) {
  directions_.reserve(rays_);
  for (size_t ray = 0; ray < rays_; ++ray)
    directions_.push_back(ray == 0 ? Vec3(0, 1, 0) : jittered(ray, Vec2(0.5)));
}

Vec3 DiffuseDirections::jittered(size_t ray, const Vec2& u) const {
  size_t first = 0, count = 1;  // of the ray's band
  // As every second band is by half a step, so that no two rays stand above each other.
  bool is_turned = false;
  if (ray > 0) {
    const size_t band = (ray - 1) / per_band_;
    first = 1 + band * per_band_;
    count = std::min(per_band_, rays_ - first);
    is_turned = band % 2 == 0;
  }
  const double share =
      (static_cast<double>(first) + u.x * static_cast<double>(count)) / static_cast<double>(rays_);
  const double sine2 = bands_ == DiffuseBands::flux ? share : 1 - std::sqrt(1 - share);
  const double sine = std::sqrt(sine2), cosine = std::sqrt(1 - sine2);
  const double step = static_cast<double>(ray - first) + (is_turned ? 0.5 : 0) + (u.y - 0.5);
  const double phi = 2 * std::numbers::pi * step / static_cast<double>(count);
  return {sine * portable_cos(phi), cosine, sine * portable_sin(phi)};
}

TurnedFrame::TurnedFrame(const Vec3& normal, double radians)
    : frame(normal), cosine(portable_cos(radians)), sine(portable_sin(radians)) {}

}  // namespace rayfarm
