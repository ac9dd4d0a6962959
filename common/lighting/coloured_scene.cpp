#include "common/lighting/coloured_scene.h"

#include <algorithm>

#include "common/materials/presets.h"

namespace rayfarm {
namespace {

/// Nodes that are closer count as one: what is between them is less than the step of integration.
constexpr double kLeastStep_nm = 0.5;
static_assert((kLastWavelength_nm - kFirstWavelength_nm) / kLeastStep_nm > kMostColourNodes);

std::vector<double> nodes_of_scene(const Scene& scene) {
  std::vector<double> all(std::begin(kBandCorners_nm), std::end(kBandCorners_nm));
  for (const SpectralColor& c : scene.spectral_colors)
    for (const SpectrumNode& node : scene.spectrum_of(c)) all.push_back(node.wavelength_nm);
  for (const Material& m : scene.materials)
    if (m.metal != kNone)
      for (const double nm : conductor_wavelengths(m.metal)) all.push_back(nm);
  std::sort(all.begin(), all.end());
  std::vector<double> nodes{kFirstWavelength_nm};
  for (const double nm : all)
    if (nm >= nodes.back() + kLeastStep_nm && nm <= kLastWavelength_nm - kLeastStep_nm) nodes.push_back(nm);
  nodes.push_back(kLastWavelength_nm);
  return nodes;
}

}  // namespace

ColouredScene::ColouredScene(const Scene& scene, const ColourPass& pass) : pass_(pass), scene_(scene) {
  if (pass.is_rgb) return;
  // Saturated colours can ask for a little less than nothing at some nodes.
  const auto convert = [&pass](const Color& rgb) { return glm::max(pass.channels_from_rgb * rgb, Color(0)); };
  header_.assign(1, scene.head());
  header_[0].background = convert(scene.head().background);
  header_[0].ambient = convert(scene.head().ambient);
  header_[0].channels_from_rgb = pass.channels_from_rgb;
  materials_.assign(scene.materials.begin(), scene.materials.end());
  for (Material& m : materials_) {
    m.color = convert(m.color);
    m.filter = glm::min(convert(m.filter), Color(1));
    m.interior = glm::min(convert(m.interior), Color(1));
    m.back = convert(m.back);
    m.through = convert(m.through);
    m.emission = convert(m.emission);
    m.index = index_at(m.index, m.abbe, pass.wavelengths_nm.x);
    if (m.metal != kNone)
      for (int c = 0; c < 3; ++c) {
        const auto constants = conductor_at(m.metal, pass.wavelengths_nm[c]);
        m.n[c] = constants.n;
        m.k[c] = constants.k;
      }
  }
  lights_.assign(scene.lights.begin(), scene.lights.end());
  for (Light& light : lights_) light.color = convert(light.color);
  media_.assign(scene.media.begin(), scene.media.end());
  for (ParticipatingMedium& medium : media_) {
    medium.absorption = convert(medium.absorption);
    medium.scattering = convert(medium.scattering);
  }
  for (const SpectralColor& c : scene.spectral_colors)
    for (int channel = 0; channel < 3; ++channel)
      (*color_of(c))[channel] = eval_spectrum(scene.spectrum_of(c), pass.wavelengths_nm[channel]);
  scene_.header = header_;
  scene_.materials = materials_;
  scene_.lights = lights_;
  scene_.media = media_;
}

void ColouredScene::set_lights(const FrameLights& lights) {
  if (lights_.empty()) lights_.assign(scene_.lights.begin(), scene_.lights.end());
  if (header_.empty()) header_.assign(1, scene_.head());
  header_[0].first_luminaire = lights.first_luminaire;
  header_[0].far_away = lights.far_away;
  shining_.clear();
  for (const uint32_t i : lights.shining) shining_.push_back(lights_[i]);
  shares_ = lights.shares;
  scene_.header = header_;
  scene_.lights = shining_;
  scene_.light_shares = shares_;
}

/// Where it stands.
Color* ColouredScene::color_of(const SpectralColor& c) {
  switch (c.field) {
    case SpectralField::color:
      return &materials_[c.index].color;
    case SpectralField::filter:
      return &materials_[c.index].filter;
    case SpectralField::interior:
      return &materials_[c.index].interior;
    case SpectralField::back:
      return &materials_[c.index].back;
    case SpectralField::through:
      return &materials_[c.index].through;
    case SpectralField::emission:
      return &materials_[c.index].emission;
    case SpectralField::n:
      return &materials_[c.index].n;
    case SpectralField::k:
      return &materials_[c.index].k;
    case SpectralField::light:
      return &lights_[c.index].color;
    case SpectralField::background:
      return &header_[0].background;
    case SpectralField::absorption:
      return &media_[c.index].absorption;
    case SpectralField::scattering:
      return &media_[c.index].scattering;
    case SpectralField::ambient:
      break;
  }
  return &header_[0].ambient;
}

std::vector<double> colour_nodes(const Scene& scene, const RenderSettings& settings) {
  if (settings.colour != ColourModel::spectral) return nodes_of(settings.colour);
  return settings.colour_nodes_nm.empty() ? nodes_of_scene(scene) : settings.colour_nodes_nm;
}

std::vector<ColouredScene> make_coloured_scenes(const Scene& scene, const RenderSettings& settings) {
  bool is_dispersive = false;
  for (const Material& m : scene.materials) is_dispersive = is_dispersive || m.abbe > 0;
  std::vector<ColouredScene> scenes;
  for (const ColourPass& pass : make_passes(colour_nodes(scene, settings), is_dispersive))
    scenes.emplace_back(scene, pass);
  return scenes;
}

}  // namespace rayfarm
