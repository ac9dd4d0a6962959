#include "common/description/formats/yaml_textures.h"

#include <fmt/core.h>

#include "common/description/formats/npy_loader.h"
#include "common/description/scene_images.h"

namespace rayfarm {
namespace {

/// The image that `file` names.
void read_image_of(YamlMap& map, TextureDescription& texture, YamlDocument& document,
                   const ImageReading& reading = {}) {
  const YamlValue file = map.require("file");
  try {
    load_scene_image(document.scene(), document.path_of(file), texture, file.stop(), reading);
  } catch (const IoError& e) {
    file.fail(e.what());
  }
}

/// Those of `values`, x fastest; one or three for each cell.
ArrayValues read_values(YamlMap& map, uint64_t most_cells) {
  ArrayValues array;
  const YamlValue size = map.require("size");
  const std::vector<YamlValue> axes = size.items();
  if (axes.size() != 3) size.fail("the size of an array is [x, y, z], in cells");
  for (size_t axis = 0; axis < 3; ++axis)
    array.size[axis] = static_cast<uint32_t>(axes[axis].whole_number_in(1, 1'000'000));
  if (array.size[0] > most_cells / array.size[1] / array.size[2])
    size.fail(fmt::format("the array has more cells than there is room for, {}", most_cells));
  const YamlValue values = map.require("values");
  const auto list = values.items_apart();
  const std::vector<YamlValue> items = list ? std::vector<YamlValue>() : values.items();
  const size_t count = list ? list->size() : items.size();
  if (count != array.cells() && count != 3 * array.cells())
    values.fail(
        fmt::format("an array of {} × {} × {} needs {} values, or three times as many for red, green "
                    "and blue, not {}",
                    array.size[0], array.size[1], array.size[2], array.cells(), count));
  array.channels = count == array.cells() ? 1 : 3;
  if (!list) {
    for (const YamlValue& item : items) array.values.push_back(static_cast<float>(item.number_in(0, 1)));
    return array;
  }
  array.values.resize(count);
  values.take_all(*list, [&](size_t, size_t i, std::span<const double> numbers) {
    if (list->is_nested() || !(numbers[0] >= 0 && numbers[0] <= 1))
      values.fail("a number from 0 to 1 was expected");
    array.values[i] = static_cast<float>(numbers[0]);
  });
  return array;
}

void read_array(YamlMap& map, TextureDescription& texture, YamlDocument& document) {
  // Its mip map has at most as many cells again, in the worst case of a single row.
  const uint64_t most_cells = std::min(limits::kArrayCells, texels_left(document.scene()) / 2);
  if (auto v = map.find("from")) texture.from = v->vector();
  if (auto v = map.find("repeat")) texture.is_repeated = v->boolean() ? 1 : 0;
  const auto file = map.find("file");
  if (!file) {
    texture.texels = make_array_texels(read_values(map, most_cells), texture, map.value().stop());
    return;
  }
  for (const char* key : {"size", "values"})
    if (auto v = map.find(key)) v->fail("give either `file` or `size` and `values`, not both");
  const std::string path = document.path_of(*file);
  try {
    texture.texels = make_array_texels(load_npy(path, most_cells, file->stop()), texture, file->stop());
  } catch (const IoError& e) {
    file->fail(e.what());
  }
  document.scene().files.push_back(path);
}

}  // namespace

TextureDescription read_texture(const std::string& name, const YamlValue& value, YamlDocument& document) {
  YamlMap map(value);
  TextureDescription texture;
  texture.name = name;
  texture.kind = static_cast<TextureKind>(
      map.require("kind").choice({kTextureKindWords.begin(), kTextureKindWords.end()}));
  if (auto v = map.find("scale")) {
    texture.scale = v->is_sequence() ? v->vector() : Vec3(v->number());
    if (!(texture.scale.x > 0 && texture.scale.y > 0 && texture.scale.z > 0))
      v->fail("a texture's scale must be above 0");
  }
  if (texture.kind == TextureKind::image) {
    ImageReading reading;
    const auto encoding = map.find("encoding");
    if (encoding)
      reading.encoding = static_cast<ImageReading::Encoding>(1 + encoding->choice({"srgb", "linear"}));
    if (auto v = map.find("part")) reading.part = static_cast<ImagePart>(v->choice({"color", "alpha"}));
    if (reading.part == ImagePart::alpha && reading.encoding == ImageReading::Encoding::srgb)
      encoding->fail("alpha is no light: its numbers are always taken as they stand");
    read_image_of(map, texture, document, reading);
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
  if (texture.kind == TextureKind::array) {
    texture.first = Color(0);
    texture.second = Color(1);
  }
  color("first", texture.first);
  color("second", texture.second);
  if (texture.kind == TextureKind::array) {
    read_array(map, texture, document);
    map.finish();
    return texture;
  }
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

uint32_t find_texture(const YamlValue& value, YamlDocument& document) {
  return document.shared.textures.find_or_make(value, [&](const std::string& name) {
    TextureDescription texture = read_texture(name, value, document);
    document.scene().textures.push_back(std::move(texture));
    return static_cast<uint32_t>(document.scene().textures.size() - 1);
  });
}

void read_environment(const YamlValue& value, YamlDocument& document) {
  SceneDescription& scene = document.scene();
  YamlMap map(value);
  TextureDescription& image = scene.environment.emplace();
  read_image_of(map, image, document);
  scene.background = Color(1);
  if (auto v = map.find("intensity")) scene.background = Color(v->number_in(0, 1e9));
  if (auto v = map.find("turn")) scene.environment_turn = v->number() / 360;
  map.finish();
}

}  // namespace rayfarm
