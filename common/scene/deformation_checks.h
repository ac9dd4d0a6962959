#pragma once
// Checks of what a scene says of parts that change their shape.
#include "common/scene/scene.h"

namespace rayfarm {

/// Throws SceneBlockError. The hierarchy, leaves and primitives are known to be whole.
void check_deformation(const Scene& scene);

}  // namespace rayfarm
