#pragma once
// Materials and lights of the YAML format. scenes/README.md is the manual.
#include "common/description/formats/yaml_document.h"

namespace rayfarm {

/// The material may name textures, and a mix the materials that there are. Photometric files are read as
/// those of lights.
MaterialDescription read_material(const std::string& name, const YamlValue& value, YamlDocument& document);
/// The number of the material that the value names, or describes.
uint32_t find_material(const YamlValue& value, YamlDocument& document, const std::string& otherwise = "");
/// Photometric files join the scene's diagrams and files.
Light read_light(const YamlValue& value, YamlDocument& document, std::vector<SpectrumDescription>& spectra);

}  // namespace rayfarm
