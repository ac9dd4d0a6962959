#include "common/description/formats/yaml_spectra.h"

#include "common/materials/illuminants.h"

namespace rayfarm {
namespace {

std::vector<SpectrumNode> read_nodes(YamlMap& map) {
  const YamlValue list = map.require("spectrum");
  const auto scale = map.find("scale");
  const double factor = scale ? scale->number_in(0, 1e9) : 1;
  std::vector<SpectrumNode> nodes;
  if (!list.is_sequence()) {
    auto illuminant = find_illuminant(list.text());
    if (!illuminant)
      list.fail_unknown("illuminant", illuminant_names(),
                        "; a list of [wavelength in nm, value] can be given, too");
    nodes = std::move(*illuminant);
    for (SpectrumNode& node : nodes) node.value *= factor;
    map.finish();
    return nodes;
  }
  for (const YamlValue& item : list.items()) {
    const std::vector<double> pair = item.is_sequence() ? item.numbers() : std::vector<double>();
    if (pair.size() != 2) item.fail("a spectrum is a list of [wavelength in nm, value]");
    if (!(pair[0] >= 1 && pair[0] <= 1e6))
      item.fail(fmt::format("a wavelength must be from 1 to 1e6 nm, not {:g}", pair[0]));
    if (!nodes.empty() && pair[0] <= nodes.back().wavelength_nm)
      item.fail(fmt::format("the wavelengths of a spectrum must rise, but {:g} follows {:g}", pair[0],
                            nodes.back().wavelength_nm));
    if (pair[1] < 0) item.fail("a value of a spectrum must not be negative");
    if (nodes.size() == limits::kSpectrumNodes)
      item.fail(fmt::format("a spectrum has no more than {} nodes", limits::kSpectrumNodes));
    nodes.push_back({pair[0], factor * pair[1]});
  }
  if (nodes.empty()) list.fail("the spectrum is empty; it needs one [wavelength in nm, value] at least");
  map.finish();
  return nodes;
}

Color rgb_for(SpectralField field, std::span<const SpectrumNode> nodes) {
  if (field == SpectralField::n || field == SpectralField::k) {
    const Vec3 wavelengths_nm = ColourPass{}.wavelengths_nm;
    Color values;
    for (int c = 0; c < 3; ++c) values[c] = eval_spectrum(nodes, wavelengths_nm[c]);
    return values;
  }
  const Color rgb = glm::max(rgb_of(nodes), Color(0));
  if (field >= SpectralField::emission) return rgb;
  double largest = 0;
  for (const SpectrumNode& node : nodes) largest = std::max(largest, node.value);
  return glm::min(rgb, Color(largest));
}

}  // namespace

Color read_color(const YamlValue& value, SpectralField field, std::vector<SpectrumDescription>& spectra,
                 size_t index) {
  if (!value.is_map()) return value.color();
  YamlMap map(value);
  spectra.push_back({field, static_cast<uint32_t>(index), read_nodes(map)});
  return rgb_for(field, spectra.back().nodes);
}

Color value_at(const MaterialDescription& material, SpectralField field, const Color& rgb,
               double wavelength_nm) {
  for (const SpectrumDescription& spectrum : material.spectra)
    if (spectrum.field == field) return Color(eval_spectrum(spectrum.nodes, wavelength_nm));
  return rgb;
}

}  // namespace rayfarm
