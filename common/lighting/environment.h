#pragma once
// What rays see that leave the scene: one colour, or an image of all directions, which is then a source of
// light, too.
#include "common/lighting/light_sampling.h"

namespace rayfarm {

/// The image's radiance from a direction (unit).
Color eval_environment(const Scene& scene, const Vec3& direction);

/// Radiance from a direction (unit), image or not.
inline Color eval_background(const Scene& scene, const Vec3& direction) {
  return scene.head().environment == kNone ? scene.head().background : eval_environment(scene, direction);
}

/// The image's texels by importance: for each row the share of the rows up to it, then for each texel the
/// share of its row's texels up to it. Texels count by their luminance and the solid angle that they fill.
std::vector<double> make_environment_shares(const Texture& image, std::span<const uint16_t> texels);

/// The mean radiance of the image over all directions.
Color mean_environment(const Texture& image, std::span<const uint16_t> texels);

/// A direction by importance, its radiance over density, and the density. The scene must have an image.
LightSample sample_environment(const Scene& scene, const Vec2& u);
/// The density with which sample_environment chooses a direction.
double environment_pdf(const Scene& scene, const Vec3& direction);

}  // namespace rayfarm
