#pragma once
// What in a scene encloses nothing. A ray that is to know what it is in (--self-hit medium: Shirley, Sung and
// Brown 1991, section 3.1) needs bodies that are closed, their normals outward.
#include "common/description/scene_description.h"

namespace rayfarm {

/// The objects that have primitives of their own which are not closed, in the scene's order. Closed are
/// spheres, quadrics that no plane cuts, and polygons of an object that together have another one beyond each
/// edge, which runs along it the other way; so are the polygons of a mesh. Two-sided sheets count for
/// nothing. Objects from compiled files are not looked at.
std::vector<uint32_t> find_open_objects(const SceneDescription& scene);

}  // namespace rayfarm
