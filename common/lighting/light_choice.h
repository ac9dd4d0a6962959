#pragma once
// Which of a scene's sources a path sends its shadow ray to.
#include <vector>

#include "common/scene/scene.h"

namespace rayfarm {

/// The shares of all sources up to each: by the irradiance that it gives at a distance of the scene's size
/// (`radius`), without what stands between.
std::vector<double> make_light_shares(const Scene& scene, double radius);

/// A source by importance: u in [0, 1). There must be one.
uint32_t choose_light(const Scene& scene, double u);
double choice_probability(const Scene& scene, uint32_t light);

/// The source that the environment's image is, if there is one: the last before the luminaires.
inline uint32_t environment_source(const Scene& scene) {
  return scene.head().first_luminaire - 1;
}

}  // namespace rayfarm
