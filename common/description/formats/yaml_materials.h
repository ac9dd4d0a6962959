#pragma once
// Materials and lights of the YAML format. scenes/README.md is the manual.
#include "common/description/formats/yaml_reader.h"

namespace rayfarm {

/// The material may name the scene's textures, and a mix the materials that the scene has. Photometric files
/// are read as those of lights.
MaterialDescription read_material(const std::string& name, const YamlValue& value, const std::string& folder,
                                  SceneDescription& scene);
/// Photometric files are read relative to the scene's folder and join its diagrams and files.
Light read_light(const YamlValue& value, const std::string& folder, SceneDescription& scene,
                 std::vector<SpectrumDescription>& spectra);

}  // namespace rayfarm
