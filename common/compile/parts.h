#pragma once
// Parts: primitives that never move against each other, and the hierarchy below them.
#include "common/hierarchy/structurer.h"
#include "common/scene/scene.h"

namespace rayfarm {

/// Builds the hierarchy over `primitives`, which is not empty, with its leaves in `arrays`. Throws Stopped.
Part build_part(SceneArrays<GrowingArray>& arrays, const PartPrimitives& primitives,
                const BuildOptions& options);

}  // namespace rayfarm
