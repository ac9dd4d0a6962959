#pragma once
// How large what a scene describes is.
#include <vector>

#include "common/description/scene_description.h"

namespace rayfarm {

/// By object: a box in the world about its own primitives in all its copies, at the first frame; empty if it
/// has none, or is not in the scene then. Tight, but of quadrics (which have none) and where meshes have so
/// many copies that only their boxes are looked at. Skins are bent, morph targets at rest; objects nested
/// deeper than limits::kObjectDepth, and those of libraries, are left out.
std::vector<Box> bounds_of_objects(const SceneDescription& scene);

/// About all of them.
Box bounds_of(const SceneDescription& scene);

}  // namespace rayfarm
