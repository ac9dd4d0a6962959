#pragma once
// The text of an OBJ file as a mesh.
#include <span>
#include <string_view>

#include "common/description/scene_description.h"

namespace rayfarm {

/// Reads the text of the file `path`, in pieces that end at the first lines' ends behind `borders`, which
/// rise: they decide which core reads what, and nothing else. Its materials and notes join the scene; faces
/// without a material have `material`. Throws InputError and Stopped.
MeshShape read_obj_mesh(SceneDescription& scene, std::string_view text, const std::string& path,
                        uint32_t material, Smoothing smoothing, std::span<const size_t> borders,
                        const std::stop_token& stop = {}, ReadProgress* progress = nullptr);

}  // namespace rayfarm
