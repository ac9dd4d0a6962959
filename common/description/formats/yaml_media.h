#pragma once
// Media of the YAML format. scenes/README.md is the manual.
#include "common/description/formats/yaml_reader.h"

namespace rayfarm {

/// The list of media that stand in boxes of the world. `folder`: to which files of densities are relative.
/// The scene's files grow by every file read.
void read_media(const YamlValue& value, const std::string& folder, SceneDescription& scene);

}  // namespace rayfarm
