#include "common/lighting/coloured_scene.h"

#include "common/materials/presets.h"

namespace rayfarm {

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
  scene_.header = header_;
  scene_.materials = materials_;
  scene_.lights = lights_;
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

std::vector<ColouredScene> make_coloured_scenes(const Scene& scene, ColourModel model) {
  bool is_dispersive = false;
  for (const Material& m : scene.materials) is_dispersive = is_dispersive || m.abbe > 0;
  std::vector<ColouredScene> scenes;
  for (const ColourPass& pass : make_passes(model, is_dispersive)) scenes.emplace_back(scene, pass);
  return scenes;
}

}  // namespace rayfarm
