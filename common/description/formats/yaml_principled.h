#pragma once
// The principled material of the YAML format. scenes/README.md is the manual.
#include "common/description/formats/yaml_document.h"

namespace rayfarm {

/// Adds the parameters to the scene's, and makes `material` one of them.
void read_principled(const YamlValue& value, MaterialDescription& material, YamlDocument& document);

}  // namespace rayfarm
