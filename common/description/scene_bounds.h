#pragma once
// How large a described scene is.
#include "common/description/scene_description.h"

namespace rayfarm {

/// The meshes of the object tree in the world, at the first frame: skins are bent, morph targets at rest. Tight but
/// where copies are so many that only their boxes are looked at. Objects that are nested too deep are left
/// out.
Box bounds_of_meshes(const SceneDescription& scene);

}  // namespace rayfarm
