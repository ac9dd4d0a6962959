#pragma once
// Mixes of materials in the YAML format. scenes/README.md is the manual.
#include "common/description/formats/yaml_document.h"

namespace rayfarm {

/// `{a, b, by}`. Its parts are materials that the scene has already, so that no mix holds itself.
void read_mix(const YamlValue& value, MaterialDescription& mix, YamlDocument& document);

}  // namespace rayfarm
