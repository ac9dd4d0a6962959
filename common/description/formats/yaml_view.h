#pragma once
// The camera of YAML scenes.
#include "common/description/formats/yaml_reader.h"
#include "common/description/scene_description.h"

namespace rayfarm {

/// `view`. Throws InputError.
void read_view(const YamlValue& value, SceneDescription& scene);

}  // namespace rayfarm
