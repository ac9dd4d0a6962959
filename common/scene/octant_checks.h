#pragma once
// Checks of trees of octants.
#include "common/scene/scene.h"

namespace rayfarm {

/// Throws SceneBlockError unless every way through the trees ends inside the arrays.
void check_octant_trees(const Scene& scene);

}  // namespace rayfarm
