#pragma once
#include "common/description/scene_description.h"
#include "common/scene/scene.h"

namespace rayfarm {

/// Adds the materials with their spectra. Textures stand there already: from their means follow the
/// coefficients that classical models take of principled materials.
void add_materials(SceneArrays<GrowingArray>& arrays, const SceneDescription& description);

}  // namespace rayfarm
