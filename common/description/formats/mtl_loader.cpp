#include "common/description/formats/mtl_loader.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "common/description/formats/records.h"
#include "common/description/formats/scene_loaders.h"
#include "common/description/scene_images.h"
#include "common/files/read_file.h"

namespace rayfarm {
namespace {

/// A material as the file says it. Numbers are float, as those of the mesh.
struct Written {
  std::string name;
  SourcePlace place;
  glm::vec3 diffuse{0}, specular{0}, emission{0};
  float shininess = 1, index = 1;
  std::optional<float> opacity, transparency;
  std::optional<int> illumination;
  bool has_diffuse = false;
  uint32_t texture = kNone;
};

class Loader {
 public:
  Loader(SceneDescription& scene, const std::string& path, const std::stop_token& stop)
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
    if (key == "newmtl") {
      finish();
      const std::string_view name = records_.rest();
      if (name.empty()) records_.fail("`newmtl` needs a name");
      written_.emplace();
      written_->name = name;
      written_->place = records_.line_place();
    } else if (!written_) {
      note(fmt::format("`{}` belongs to no material: it stands before the first `newmtl`", short_of(key)));
    } else if (key == "Kd") {
      written_->diffuse = color();
      written_->has_diffuse = true;
    } else if (key == "Ks") {
      written_->specular = color();
      const glm::vec3& s = written_->specular;
      if (s.x != s.y || s.y != s.z)
        note_once("the colour of `Ks`", "highlights and reflections take the mean of its three numbers");
    } else if (key == "Ke") {
      written_->emission = color();
    } else if (key == "Ns") {
      written_->shininess = number();
      if (written_->shininess < 0) records_.fail("`Ns` must be 0 or more");
    } else if (key == "Ni") {
      written_->index = number();
    } else if (key == "d") {
      if (records_.peek() == "-halo") {
        records_.word();
        note_once("`-halo`", "the opacity is the same from all sides");
      }
      written_->opacity = number();
    } else if (key == "Tr") {
      written_->transparency = number();
    } else if (key == "illum") {
      written_->illumination = static_cast<int>(std::clamp(number(), -1e6f, 1e6f));
    } else if (key == "map_Kd") {
      written_->texture = read_map();
    } else if (key == "Tf" && color() == glm::vec3(1)) {
      // what passes is not filtered
    } else {
      note_unused(key);
    }
  }

  void note(std::string_view text) { scene_.notes.add(records_.line_place(), text); }
  void note_once(const std::string& what, std::string_view instead) {
    if (noted_.insert(what).second) note(fmt::format("{} is not used: {}", what, instead));
  }
  static std::string_view short_of(std::string_view word) { return word.substr(0, 40); }

  void note_unused(std::string_view key) {
    static const std::vector<std::pair<std::string_view, std::string_view>> kKnown{
        {"Ka", "ambient light takes a fifth of `Kd`"},
        {"Tf", "what passes is not filtered"},
        {"map_Ka", "only `map_Kd` is read of the maps"},
        {"map_Ks", "only `map_Kd` is read of the maps"},
        {"map_Ke", "only `map_Kd` is read of the maps"},
        {"map_Ns", "only `map_Kd` is read of the maps"},
        {"map_d", "only `map_Kd` is read of the maps"},
        {"map_bump", "give the material a `bump` in a .yaml scene"},
        {"map_Bump", "give the material a `bump` in a .yaml scene"},
        {"bump", "give the material a `bump` in a .yaml scene"},
        {"norm", "give the material a `bump` in a .yaml scene"},
        {"Pr", "a rough metal is a `conductor` with an `exponent` in a .yaml scene"},
        {"Pm", "a metal is a `conductor` in a .yaml scene"}};
    constexpr size_t kMostKinds = 24;
    if (noted_.size() > kMostKinds) return;
    const auto known =
        std::find_if(kKnown.begin(), kKnown.end(), [key](const auto& entry) { return entry.first == key; });
    if (known != kKnown.end()) return note_once(fmt::format("`{}`", key), known->second);
    static const std::vector<std::string> kUsed{"newmtl", "Kd", "Ks", "Ke",    "Ns",
                                                "Ni",     "d",  "Tr", "illum", "map_Kd"};
    note_once(fmt::format("`{}`", short_of(key)),
              fmt::format("read are {}{}", fmt::join(kUsed, ", "), suggestion(key, kUsed)));
  }

  float number() {
    const auto value = static_cast<float>(records_.number());
    if (!std::isfinite(value)) records_.fail("the number is too large");
    return value;
  }
  glm::vec3 color() {
    if (const std::string_view kind = records_.peek(); kind == "spectral" || kind == "xyz") {
      records_.word();
      records_.fail(fmt::format("`{}` colours are not read; write red, green and blue", kind));
    }
    glm::vec3 c(number());  // one number is grey
    if (records_.has_more() && !records_.peek().starts_with('#')) {
      c.y = number();
      c.z = number();
    }
    if (c.x < 0 || c.y < 0 || c.z < 0) records_.fail("a colour must not be negative");
    return c;
  }

  /// `map_Kd [options] file`.
  uint32_t read_map() {
    const SourcePlace place = records_.line_place();
    Vec2 offset(0), scale(1);
    while (records_.peek().starts_with('-')) {
      const std::string option(records_.word());
      if (option == "-o" || option == "-s" || option == "-t") {
        Vec3 v(option == "-s" ? 1 : 0);
        // The second and third may be left out, and a file's name may begin as a number does.
        for (int i = 0; i < 3 && parse_number(records_.peek()); ++i) v[i] = records_.number();
        if (option == "-o") offset = Vec2(v);
        if (option == "-s") {
          if (v.x == 0 || v.y == 0) records_.fail("the scale of a map must not be 0");
          scale = Vec2(v);
        }
        if (option == "-t") note_map_option(option);
      } else if (option == "-mm") {
        records_.number();
        records_.number();
        note_map_option(option);
      } else {
        static const std::set<std::string> kWithOneWord{"-bm",    "-boost", "-texres",  "-blendu", "-blendv",
                                                        "-clamp", "-cc",    "-imfchan", "-type"};
        if (!kWithOneWord.contains(option))
          records_.fail(fmt::format("unknown option '{}' of a map", short_of(option)));
        if (records_.word() != "off" || option != "-clamp") note_map_option(option);
      }
    }
    std::string name(records_.rest());
    if (name.empty()) records_.fail("`map_Kd` names no file");
    std::replace(name.begin(), name.end(), '\\', '/');
    return texture(name, offset, scale, records_.place());
  }
  void note_map_option(const std::string& option) {
    note_once(fmt::format("`{}`", option), "a map has `-o` and `-s`, and is repeated");
  }

  /// Materials that name the same image in the same place share it.
  uint32_t texture(const std::string& name, const Vec2& offset, const Vec2& scale, const SourcePlace& place) {
    const std::string file = (std::filesystem::path(path_).parent_path() / name).lexically_normal().string();
    TextureDescription texture;
    texture.name = "map_Kd " + file;
    texture.scale = Vec3(1.0 / scale.x, 1.0 / scale.y, 1);
    texture.offset = offset;
    const auto same = [&texture](const TextureDescription& t) {
      return t.name == texture.name && t.scale == texture.scale && t.offset == texture.offset;
    };
    const auto found = std::find_if(scene_.textures.begin(), scene_.textures.end(), same);
    if (found != scene_.textures.end()) return static_cast<uint32_t>(found - scene_.textures.begin());
    try {
      load_scene_image(scene_, file, texture, stop_);
    } catch (const IoError& e) {
      throw InputError(place, e.what());
    }
    scene_.textures.push_back(std::move(texture));
    return static_cast<uint32_t>(scene_.textures.size() - 1);
  }

  /// The material that was read last, if any, joins the scene.
  void finish() {
    if (!written_) return;
    const Written& w = *written_;
    const auto note_here = [&](std::string_view text) { scene_.notes.add(w.place, text); };
    MaterialDescription m(w.name);
    m.color = Color(w.has_diffuse || w.texture == kNone ? w.diffuse : glm::vec3(1));
    m.texture = w.texture;
    if (!w.has_diffuse && w.texture == kNone && w.emission == glm::vec3(0))
      note_here(fmt::format("material '{}' has no `Kd`: it is black", w.name));
    m.specular = static_cast<double>(w.specular.x + w.specular.y + w.specular.z) / 3.0;
    m.shininess = static_cast<double>(w.shininess);
    // Which of the two counts where they contradict each other is not said anywhere; most read `d`.
    const float opacity = w.opacity ? *w.opacity : w.transparency ? 1.0f - *w.transparency : 1.0f;
    if (w.opacity && w.transparency && std::abs(*w.opacity + *w.transparency - 1) > 1e-3f)
      note_here(fmt::format("`Tr` {:g} of material '{}' is not used: `d` says {:g}", *w.transparency, w.name,
                            *w.opacity));
    // MTL: illum 3 and above ask for reflection, 4, 6, 7 and 9 for glass; d is the opacity.
    const int illum = w.illumination.value_or(2);
    const bool is_glass = illum == 4 || illum == 6 || illum == 7 || illum == 9;
    m.reflect = illum >= 3 ? m.specular : 0;
    m.transmit = is_glass ? 1.0 - static_cast<double>(opacity) : 0;
    m.index = w.index > 0 ? static_cast<double>(w.index) : 1;
    if (!is_glass && opacity != 1)
      note_here(fmt::format(
          "material '{}' is opaque: its `d` or `Tr` is used with `illum` 4, 6, 7 or 9 alone", w.name));
    if (illum <= 0 || illum > 9 || (illum == 1 && m.specular != 0))
      note_here(fmt::format("`illum` {} of material '{}' is not used: it is shaded as by `illum` 2", illum,
                            w.name));
    if (w.emission != glm::vec3(0)) {
      // What shines is a luminaire: an albedo and the light of its own.
      if (m.specular != 0 || m.transmit != 0)
        note_here(fmt::format("material '{}' shines: its `Ke` and `Kd` are used, its `Ks` and `d` are not",
                              w.name));
      m.kind = MaterialKind::luminaire;
      m.emission = Color(w.emission);
      m.ambient = m.specular = m.reflect = m.transmit = 0;
      m.diffuse = 1;
    }
    const auto id = static_cast<uint32_t>(scene_.materials.size());
    if (ids_.emplace(w.name, id).second)
      scene_.materials.push_back(std::move(m));
    else
      note_here(fmt::format("material '{}' is defined twice; the first one is used", w.name));
    written_.reset();
  }

  SceneDescription& scene_;
  const std::string& path_;
  const std::stop_token& stop_;
  std::string text_;
  Records records_;
  std::optional<Written> written_;
  MaterialIds ids_;
  std::set<std::string> noted_;
};

}  // namespace

MaterialIds load_mtl(SceneDescription& scene, const std::string& path, const std::stop_token& stop) {
  return Loader(scene, path, stop).load();
}

}  // namespace rayfarm
