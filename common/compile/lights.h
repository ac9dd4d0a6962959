#pragma once
// Sources of light: those that the description lists, the environment, and every luminous primitive of every
// instance.
#include "common/compile/luminaires.h"
#include "common/scene/scene.h"

namespace rayfarm {

/// The listed lights, and the diagrams of all.
void add_listed_lights(SceneArrays<GrowingArray>& arrays, const SceneDescription& description);

/// The image that lights the scene from all around, if there is one, behind all lights so far.
void add_environment(SceneArrays<GrowingArray>& arrays, const SceneDescription& description);

/// A light for each luminous primitive (by part, `luminous_of`) of each instance; returns where each comes
/// from. Throws InputError if there are too many.
std::vector<Place> add_luminaires(SceneArrays<GrowingArray>& arrays, const SceneDescription& description,
                                  const Luminaires& luminaires,
                                  std::span<const std::vector<Luminous>> luminous_of);

/// With which shares lights, and directions of the environment, are chosen; and how far it is out of the
/// scene.
void weigh_lights(SceneArrays<GrowingArray>& arrays);

}  // namespace rayfarm
