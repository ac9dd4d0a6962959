#pragma once
// Textures of the YAML format. scenes/README.md is the manual.
#include "common/scene/yaml_reader.h"

namespace rayfarm {

/// `folder`: to which image files are relative. `files` grows by every file read.
TextureDescription read_texture(const std::string& name, const YamlValue& value, const std::string& folder,
                                std::vector<std::string>& files);

/// The image that is seen behind the scene.
void read_environment(const YamlValue& value, const std::string& folder, SceneDescription& scene);

}  // namespace rayfarm
