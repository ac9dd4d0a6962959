#pragma once
// Media that stand in boxes.
#include "common/description/scene_description.h"
#include "common/scene/scene.h"

namespace rayfarm {

/// All of the description's, with their densities and the most of these in each block.
void add_media(SceneArrays<GrowingArray>& arrays, const SceneDescription& description);

}  // namespace rayfarm
