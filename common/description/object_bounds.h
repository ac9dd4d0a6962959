#pragma once
// How far objects of a description reach, for views of files that have none.
#include "common/description/scene_description.h"

namespace rayfarm {

/// Of an object and those in it in `frame`, in the object's space: a box about the boxes of what is in it.
/// Skins are bent; morph targets, and parts of compiled files, are left out. The tree must be no deeper than
/// `limits` say.
Box bounds_of_object(const SceneDescription& scene, uint32_t object, double frame);

/// Looks at a box from the front, +z, from so far that all of it is seen. Nothing if it is empty.
void look_at(const Box& bounds, ViewDescription& view);

}  // namespace rayfarm
