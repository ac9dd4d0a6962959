#pragma once
// Scenes from YAML texts: what load_yaml_scene does with a file's. Both throw Stopped.
#include <optional>
#include <string>
#include <string_view>

#include "common/description/scene_description.h"

namespace rayfarm {

/// Every value of the text is read as a YAML value. Throws InputError.
SceneDescription read_yaml_whole(std::string_view text, const std::string& path,
                                 const LoadOptions& options = {});

/// The same scene, but lists of numbers of `least_bytes` and more are read apart (yaml_outline.h). Nothing if
/// the text has none and includes nothing, is none to outline or is wrong: read_yaml_whole tells where and
/// why.
std::optional<SceneDescription> read_yaml_outline(std::string_view text, const std::string& path,
                                                  size_t least_bytes, const LoadOptions& options = {});

}  // namespace rayfarm
