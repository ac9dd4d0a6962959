#pragma once
// A file of a mesh as a scene of its own.
#include "common/description/scene_description.h"

namespace rayfarm {

/// A scene that takes a mesh from a file and shows it as load_mesh_scene does, to start from. `file` is the
/// mesh's name relative to the scene's folder. Throws InputError, IoError and Stopped.
std::string yaml_of_mesh_scene(const std::string& path, const std::string& file, const LoadOptions& options);

}  // namespace rayfarm
