#pragma once
// Textures of the YAML format. scenes/README.md is the manual.
#include "common/description/formats/yaml_document.h"

namespace rayfarm {

/// The scene's files grow by every file read.
TextureDescription read_texture(const std::string& name, const YamlValue& value, YamlDocument& document);

/// The number of the texture that the value names, or describes.
uint32_t find_texture(const YamlValue& value, YamlDocument& document);

/// The image that is seen behind the scene.
void read_environment(const YamlValue& value, YamlDocument& document);

}  // namespace rayfarm
