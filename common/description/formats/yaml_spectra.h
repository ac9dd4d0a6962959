#pragma once
// Colours of the YAML format that may be spectra. scenes/README.md is the manual.
#include "common/description/formats/yaml_reader.h"

namespace rayfarm {

/// A colour, or `{spectrum: [[nm, value], …] or the name of an illuminant, scale}`, which joins `spectra`;
/// its RGB is returned: of a reflectance no more than the spectrum's largest value, as Rec. 709 can't show
/// all colours. `index`: of the light or medium.
Color read_color(const YamlValue& value, SpectralField field, std::vector<SpectrumDescription>& spectra,
                 size_t index = 0);

/// The largest channel of `value(nm)`, which the material's colours make, over the wavelengths where it can
/// be.
template <typename Value>
double largest_value(const MaterialDescription& material, Value value) {
  double largest = max_component(value(0));
  for (const SpectrumDescription& spectrum : material.spectra)
    for (const SpectrumNode& node : spectrum.nodes)
      largest = std::max(largest, max_component(value(node.wavelength_nm)));
  return largest;
}

/// A material's colour at a wavelength: thrice its spectrum's value there, or its RGB.
Color value_at(const MaterialDescription& material, SpectralField field, const Color& rgb,
               double wavelength_nm);

}  // namespace rayfarm
