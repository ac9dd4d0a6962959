#pragma once
// Whether a scene's arrays can be traversed and shaded: whatever they hold, nothing is read outside of them,
// and a ray's walk ends after no more work than the arrays are long.
#include "common/scene/scene.h"

namespace rayfarm {

/// Throws SceneBlockError.
void check_scene(const Scene& scene);

}  // namespace rayfarm
