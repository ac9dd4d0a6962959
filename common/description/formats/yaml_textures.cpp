#include "common/description/formats/yaml_textures.h"

#include <filesystem>

#include "common/description/scene_images.h"

namespace rayfarm {
namespace {

/// The image that `file` names.
void read_image_of(YamlMap& map, const std::string& folder, TextureDescription& texture,
                   SceneDescription& scene) {
  const YamlValue file = map.require("file");
  try {
    load_scene_image(scene, (std::filesystem::path(folder) / file.text()).string(), texture, file.stop());
  } catch (const IoError& e) {
    file.fail(e.what());
  }
}

}  // namespace

TextureDescription read_texture(const std::string& name, const YamlValue& value, const std::string& folder,
                                SceneDescription& scene) {
  YamlMap map(value);
  TextureDescription texture;
  texture.name = name;
  // In the order of TextureKind.
  static const std::vector<std::string> kKinds{"checker", "noise",  "marble",  "wood",
                                               "boards",  "bricks", "fourier", "image"};
  texture.kind = static_cast<TextureKind>(map.require("kind").choice(kKinds));
  if (auto v = map.find("scale")) {
    texture.scale = v->is_sequence() ? v->vector() : Vec3(v->number());
    if (!(texture.scale.x > 0 && texture.scale.y > 0 && texture.scale.z > 0))
      v->fail("a texture's scale must be above 0");
  }
  if (texture.kind == TextureKind::image) {
    read_image_of(map, folder, texture, scene);
    map.finish();
    return texture;
  }
  if (auto v = map.find("map")) texture.is_mapped = v->choice({"solid", "uv"}) == 1 ? 1 : 0;
  const auto color = [&map](const char* key, Color& target) {
    if (auto v = map.find(key)) target = v->color();
  };
  const auto number = [&map](const char* key, double& target, double least, double most) {
    if (auto v = map.find(key)) target = v->number_in(least, most);
  };
  color("first", texture.first);
  color("second", texture.second);
  if (auto v = map.find("octaves")) texture.octaves = static_cast<uint32_t>(v->whole_number_in(1, 16));
  if (auto v = map.find("seed")) texture.seed = static_cast<uint32_t>(v->whole_number_in(0, 1'000'000'000));
  number("strength", texture.strength, 0, 1e6);
  if (texture.kind == TextureKind::boards || texture.kind == TextureKind::bricks) {
    texture.aspect = texture.kind == TextureKind::boards ? 8 : 2.5;
    texture.gap = texture.kind == TextureKind::boards ? 0.02 : 0.15;
    number("aspect", texture.aspect, 1e-3, 1e3);
    number("gap", texture.gap, 0, 0.5);
  }
  map.finish();
  return texture;
}

void read_environment(const YamlValue& value, const std::string& folder, SceneDescription& scene) {
  YamlMap map(value);
  TextureDescription& image = scene.environment.emplace();
  read_image_of(map, folder, image, scene);
  scene.background = Color(1);
  if (auto v = map.find("intensity")) scene.background = Color(v->number_in(0, 1e9));
  if (auto v = map.find("turn")) scene.environment_turn = v->number() / 360;
  map.finish();
}

}  // namespace rayfarm
