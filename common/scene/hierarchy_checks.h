#pragma once
// Whether a scene's hierarchies can be traversed.
#include "common/scene/scene.h"

namespace rayfarm {

/// Throw SceneBlockError.
void check_hierarchy(const Scene& scene);
void check_leaves(const Scene& scene);

}  // namespace rayfarm
