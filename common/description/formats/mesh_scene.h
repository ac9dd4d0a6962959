#pragma once
// A file of a mesh as a scene of its own.
#include "common/description/scene_description.h"

namespace rayfarm {

/// A scene that takes a model from a file and shows it as the file itself is shown, to go on from. `file` is
/// the mesh's name relative to the scene's folder. Throws InputError, IoError and Stopped.
std::string yaml_of_mesh_scene(const std::string& path, const std::string& file, const LoadOptions& options);

/// The mesh alone, as it stands in its file: what a scene has that names it with no other key. Throws
/// InputError, IoError and Stopped.
SceneDescription load_bare_mesh(const std::string& path, const LoadOptions& options);

}  // namespace rayfarm
