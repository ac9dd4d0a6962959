#pragma once
// The text of an NFF file as a scene.
#include <span>
#include <string_view>

#include "common/description/scene_description.h"

namespace rayfarm {

/// Reads the text of the file `path`, in pieces that end before the first records behind `borders` that begin
/// a line; borders rise. They decide which core reads what and where a mesh of triangles ends, and nothing
/// else. Throws InputError and Stopped.
SceneDescription read_nff_scene(std::string_view text, const std::string& path,
                                std::span<const size_t> borders, const std::stop_token& stop = {},
                                ReadProgress* progress = nullptr);

}  // namespace rayfarm
