#pragma once
// Media of the YAML format. scenes/README.md is the manual.
#include "common/description/formats/yaml_document.h"

namespace rayfarm {

/// The list of media that stand in boxes of the world. The scene's files grow by every file
/// read.
void read_media(const YamlValue& value, YamlDocument& document);

}  // namespace rayfarm
