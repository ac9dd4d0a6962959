#pragma once
// Materials of Wavefront MTL files, the companions of OBJ meshes: a table of what is used is in
// scenes/README.md, all else is noted.
#include <functional>
#include <map>

#include "common/description/scene_description.h"

namespace rayfarm {

/// The ids of an MTL file's materials by their names.
using MaterialIds = std::map<std::string, uint32_t, std::less<>>;

/// Appends the file's materials, and the images that they name, to the scene. Throws IoError if the file
/// itself can't be read, InputError for what is wrong in it, and Stopped.
MaterialIds load_mtl(SceneDescription& scene, const std::string& path, const std::stop_token& stop);

}  // namespace rayfarm
