#pragma once
// The text of an OBJ file as a mesh.
#include <span>
#include <string_view>

#include "common/description/formats/mesh_loaders.h"
#include "common/files/read_file.h"

namespace rayfarm {

/// Reads the text of the file that is asked for, in pieces that end at the first records' ends behind
/// `borders`, which rise: they decide which core reads what, and nothing else. Its materials and notes join
/// the scene. `file`, unless null, is what holds the text: memory of what is
/// read is given back. Throws InputError and Stopped.
MeshShape read_obj_mesh(SceneDescription& scene, std::string_view text, const MeshRequest& request,
                        std::span<const size_t> borders, const LoadOptions& options = {},
                        FileText* file = nullptr);

}  // namespace rayfarm
