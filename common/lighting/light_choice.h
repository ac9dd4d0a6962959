#pragma once
// Which of a scene's sources a path sends its shadow ray to.
#include <vector>

#include "common/scene/scene.h"

namespace rayfarm {

/// The irradiance that a source gives at a distance of 1, without what stands between.
struct LightPower {
  double irradiance = 0;
  bool falls = true;  ///< with the square of the distance
};
/// Of all the scene's sources. Looks at every pixel of an environment.
std::vector<LightPower> light_powers(const Scene& scene);

/// The shares of all sources up to each: by the irradiance at a distance of the scene's size (`radius`).
std::vector<double> make_light_shares(std::span<const LightPower> powers, double radius);

/// A source by importance: u in [0, 1). There must be one.
uint32_t choose_light(const Scene& scene, double u);
double choice_probability(const Scene& scene, uint32_t light);

/// The source that the environment's image is, if there is one: the last before the luminaires.
inline uint32_t environment_source(const Scene& scene) {
  return scene.head().first_luminaire - 1;
}

}  // namespace rayfarm
