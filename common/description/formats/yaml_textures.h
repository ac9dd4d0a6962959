#pragma once
// Textures of the YAML format. scenes/README.md is the manual.
#include "common/description/formats/yaml_reader.h"

namespace rayfarm {

/// `folder`: to which image files are relative. The scene's files grow by every file read.
TextureDescription read_texture(const std::string& name, const YamlValue& value, const std::string& folder,
                                SceneDescription& scene);

/// The number of the texture that the value names.
uint32_t find_texture(const YamlValue& value, const std::vector<TextureDescription>& textures);

/// The image that is seen behind the scene.
void read_environment(const YamlValue& value, const std::string& folder, SceneDescription& scene);

}  // namespace rayfarm
