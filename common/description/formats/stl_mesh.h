#pragma once
// The bytes of an STL file as a mesh.
#include "common/description/formats/mesh_loaders.h"

namespace rayfarm {

/// Reads the file that is asked for. Text is cut at the first lines behind `borders`, which rise, that begin
/// a facet: they decide which core reads what, and nothing else. What is not used is noted in the scene.
/// Throws InputError and Stopped.
MeshShape read_stl_mesh(SceneDescription& scene, std::string_view bytes, const MeshRequest& request,
                        std::span<const size_t> borders, const LoadOptions& options);

}  // namespace rayfarm
