#include "common/description/formats/mtl_loader.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "common/description/formats/mtl_material.h"
#include "common/description/formats/records.h"
#include "common/files/read_file.h"

namespace rayfarm {
namespace {

using Colors = std::optional<glm::vec3> MtlMaterial::*;
using Numbers = std::optional<float> MtlMaterial::*;
using Maps = std::optional<MtlMap> MtlMaterial::*;

constexpr std::pair<std::string_view, Colors> kColors[] = {{"Kd", &MtlMaterial::diffuse},
                                                           {"Ks", &MtlMaterial::specular},
                                                           {"Ke", &MtlMaterial::emission},
                                                           {"Tf", &MtlMaterial::filter}};
constexpr std::pair<std::string_view, Numbers> kNumbers[] = {
    {"Ns", &MtlMaterial::shininess},    {"Ni", &MtlMaterial::index},          {"d", &MtlMaterial::opacity},
    {"Tr", &MtlMaterial::transparency}, {"Pr", &MtlMaterial::roughness},      {"Pm", &MtlMaterial::metallic},
    {"Pc", &MtlMaterial::coat},         {"Pcr", &MtlMaterial::coat_roughness}};
/// In small letters, as exporters do not agree on them.
constexpr std::pair<std::string_view, Maps> kMaps[] = {
    {"map_kd", &MtlMaterial::diffuse_map},        {"map_ks", &MtlMaterial::specular_map},
    {"map_ke", &MtlMaterial::emission_map},       {"map_d", &MtlMaterial::opacity_map},
    {"map_bump", &MtlMaterial::bump_map},         {"bump", &MtlMaterial::bump_map},
    {"map_kn", &MtlMaterial::normal_map},         {"norm", &MtlMaterial::normal_map},
    {"map_norm", &MtlMaterial::normal_map},       {"map_pr", &MtlMaterial::roughness_map},
    {"map_pm", &MtlMaterial::metallic_map},       {"map_pc", &MtlMaterial::coat_map},
    {"map_pcr", &MtlMaterial::coat_roughness_map}};

template <typename Member, size_t kCount>
const Member* find(const std::pair<std::string_view, Member> (&table)[kCount], std::string_view key) {
  for (const auto& [name, member] : table)
    if (name == key) return &member;
  return nullptr;
}

/// Keys that others write, and why nothing comes of them.
constexpr std::pair<std::string_view, std::string_view> kUnused[] = {
    {"Ka", "ambient light takes a fifth of `Kd`"},
    {"map_Ka", "ambient light takes a fifth of `Kd`"},
    {"map_Ns", "a map of roughness is `map_Pr`"},
    {"map_Tr", "a map of opacity is `map_d`"},
    {"map_refl", "what surrounds the scene is reflected"},
    {"refl", "what surrounds the scene is reflected"},
    {"disp", "surfaces are not displaced; `map_Bump` tilts their normals"},
    {"map_disp", "surfaces are not displaced; `map_Bump` tilts their normals"},
    {"decal", "a material has one map of colours"},
    {"map_aat", "textures are always filtered"},
    {"sharpness", "reflections are as sharp as the material"},
    {"Ps", "there is no sheen"},
    {"map_Ps", "there is no sheen"},
    {"aniso", "highlights are round"},
    {"anisor", "highlights are round"}};

class MtlReader {
 public:
  MtlReader(SceneDescription& scene, const std::string& path, const std::stop_token& stop)
      : scene_(scene),
        path_(path),
        stop_(stop),
        text_(read_text_file(path, limits::kFileBytes, stop)),
        records_(text_, path, stop) {}

  MaterialIds load() {
    scene_.files.push_back(path_);
    while (records_.next()) read_record();
    finish();
    return std::move(ids_);
  }

 private:
  void read_record() {
    const std::string_view key = records_.keyword();
    std::string small(key.substr(0, 40));
    std::transform(small.begin(), small.end(), small.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    if (key == "newmtl") {
      finish();
      written_ = MtlMaterial();
      written_.place = records_.line_place();
      written_.name = records_.rest();
      if (written_.name.empty()) records_.fail("`newmtl` needs a name");
    } else if (written_.name.empty()) {
      note(
          fmt::format("`{}` belongs to no material: it stands before the first `newmtl`", key.substr(0, 40)));
    } else if (const Colors* color = find(kColors, key)) {
      written_.*(*color) = read_color();
    } else if (const Numbers* number = find(kNumbers, key)) {
      read_number(*number);
    } else if (key == "illum") {
      written_.illumination = static_cast<int>(std::clamp(read_float(), -1e6f, 1e6f));
    } else if (const Maps* map = find(kMaps, small)) {
      written_.*(*map) =
          read_map(std::string(key), (*map) == &MtlMaterial::bump_map || (*map) == &MtlMaterial::normal_map);
    } else {
      note_unused(key);
    }
  }

  void note(std::string_view text) { scene_.notes.add(records_.line_place(), text); }
  void note_once(const std::string& what, std::string_view instead) {
    constexpr size_t kMostKinds = 24;
    if (noted_.size() <= kMostKinds && noted_.insert(what).second)
      note(fmt::format("{} is not used: {}", what, instead));
  }

  void note_unused(std::string_view key) {
    const std::string what = fmt::format("`{}`", key.substr(0, 40));
    if (const std::string_view* why = find(kUnused, key)) return note_once(what, *why);
    std::vector<std::string> used{"newmtl",   "illum", "map_Kd", "map_Ks", "map_Ke", "map_d",
                                  "map_Bump", "norm",  "map_Pr", "map_Pm", "map_Pc", "map_Pcr"};
    for (const auto& [name, member] : kColors) used.emplace_back(name);
    for (const auto& [name, member] : kNumbers) used.emplace_back(name);
    note_once(what, fmt::format("read are {}{}", fmt::join(used, ", "), suggestion(key, used)));
  }

  float read_float() {
    const auto value = static_cast<float>(records_.number());
    if (!std::isfinite(value)) records_.fail("the number is too large");
    return value;
  }
  void read_number(Numbers member) {
    if (member == &MtlMaterial::opacity && records_.peek() == "-halo") {
      records_.word();
      note_once("`-halo`", "the opacity is the same from all sides");
    }
    const float value = read_float();
    if (member == &MtlMaterial::shininess && value < 0) records_.fail("`Ns` must be 0 or more");
    written_.*member = value;
  }
  glm::vec3 read_color() {
    if (const std::string_view kind = records_.peek(); kind == "spectral" || kind == "xyz") {
      records_.word();
      records_.fail(fmt::format("`{}` colours are not read; write red, green and blue", kind));
    }
    glm::vec3 c(read_float());  // one number is grey
    if (records_.has_more() && !records_.peek().starts_with('#')) {
      c.y = read_float();
      c.z = read_float();
    }
    if (c.x < 0 || c.y < 0 || c.z < 0) records_.fail("a colour must not be negative");
    return c;
  }

  /// `map_Kd [options] file`.
  MtlMap read_map(const std::string& key, bool is_bump) {
    MtlMap map;
    while (records_.peek().starts_with('-')) read_map_option(map, is_bump);
    map.file = records_.rest();
    map.place = records_.place();
    // Some write the options behind the file's name.
    if (const size_t at = map.file.rfind(" -bm "); is_bump && at != std::string::npos)
      if (const auto value = parse_number(std::string_view(map.file).substr(at + 5));
          value && std::abs(*value) < 1e6) {
        map.bump = *value;
        map.file.erase(at);
      }
    std::string& file = map.file;
    if (file.size() > 1 && file.front() == '"' && file.back() == '"') file = file.substr(1, file.size() - 2);
    if (file.empty()) records_.fail(fmt::format("`{}` names no file", key));
    std::replace(file.begin(), file.end(), '\\', '/');
    return map;
  }

  void read_map_option(MtlMap& map, bool is_bump) {
    const std::string option(records_.word());
    const auto say = [&](std::string_view why) { note_once(fmt::format("`{}` of a map", option), why); };
    if (option == "-o" || option == "-s" || option == "-t") {
      Vec3 v(option == "-s" ? 1 : 0);
      // The second and third may be left out, and a file's name may begin as a number does.
      for (int i = 0; i < 3 && parse_number(records_.peek()); ++i) v[i] = records_.number();
      if (option == "-o") map.offset = Vec2(v);
      if (option == "-s") {
        if (v.x == 0 || v.y == 0) records_.fail("the scale of a map must not be 0");
        map.scale = Vec2(v);
      }
      if (option == "-t" && v != Vec3(0)) say("maps are not disturbed");
    } else if (option == "-mm") {
      const double base = records_.number(), gain = records_.number();
      if (base != 0 || gain != 1) say("a map is weighed by the number or colour beside it");
    } else if (option == "-bm") {
      map.bump = records_.number();
      if (std::abs(map.bump) > 1e6) records_.fail("a map of bumps is scaled by 1e6 at most");
      if (!is_bump) say("it scales bumps, and this is no map of them");
    } else if (option == "-clamp") {
      map.is_clamped = records_.word() == "on";
    } else if (option == "-imfchan") {
      const std::string_view channel = records_.word();
      if (channel.size() != 1 || std::string_view("rgbmlz").find(channel) == std::string_view::npos)
        records_.fail("`-imfchan` is one of r, g, b, m (alpha), l (luminance) and z");
      map.channel = channel.front();
      if (map.channel == 'z') say("an image has no depth: its luminance stands for it");
    } else if (option == "-blendu" || option == "-blendv") {
      if (records_.word() == "off") say("textures are always filtered");
    } else if (option == "-cc") {
      if (records_.word() == "on") say("colours are taken as they are");
    } else if (option == "-boost" || option == "-texres" || option == "-type") {
      records_.word();
      say(option == "-type" ? "a map lies in (u, v)" : "textures are filtered by what a ray sees of them");
    } else {
      records_.fail(fmt::format("unknown option '{}' of a map", option.substr(0, 40)));
    }
  }

  /// The material that was read last, if any, joins the scene.
  void finish() {
    if (written_.name.empty()) return;
    const auto id = static_cast<uint32_t>(scene_.materials.size());
    if (ids_.emplace(written_.name, id).second)
      add_mtl_material(scene_, path_, written_, stop_);
    else
      scene_.notes.add(written_.place,
                       fmt::format("material '{}' is defined twice; the first one is used", written_.name));
    written_ = MtlMaterial();
  }

  SceneDescription& scene_;
  const std::string& path_;
  const std::stop_token& stop_;
  std::string text_;
  Records records_;
  MtlMaterial written_;  ///< without a name before the first
  MaterialIds ids_;
  std::set<std::string> noted_;
};

}  // namespace

MaterialIds load_mtl(SceneDescription& scene, const std::string& path, const std::stop_token& stop) {
  return MtlReader(scene, path, stop).load();
}

}  // namespace rayfarm
