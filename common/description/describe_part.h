#pragma once
// Compiled objects back in a description: their object tree, lights, materials and textures are described
// again, so that they move, come and go, and are copied as all others; their primitives stay as they are
// built.
#include "common/description/scene_description.h"

namespace rayfarm {

/// Reads the file and adds what it holds to the scene; returns the object that all of it is. Its lights come
/// along where they stand in objects. Throws IoError, InputError if the scene would have too many objects,
/// Stopped.
uint32_t add_part_file(SceneDescription& scene, const std::string& path, const Place& place,
                       const std::stop_token& stop);

}  // namespace rayfarm
