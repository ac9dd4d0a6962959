// Rayfarm's scene format. scenes/README.md is its manual.
#include <filesystem>
#include <istream>
#include <set>

#include "common/description/formats/mesh_loaders.h"
#include "common/description/formats/scene_loaders.h"
#include "common/description/formats/stoppable_text.h"
#include "common/description/formats/yaml_curves.h"
#include "common/description/formats/yaml_materials.h"
#include "common/description/formats/yaml_media.h"
#include "common/description/formats/yaml_nodes.h"
#include "common/description/formats/yaml_reader.h"
#include "common/description/formats/yaml_scene.h"
#include "common/description/formats/yaml_spectra.h"
#include "common/description/formats/yaml_textures.h"
#include "common/description/formats/yaml_view.h"
#include "common/files/read_file.h"
#include "common/image/image_file.h"

namespace rayfarm {
namespace {

/// Lists of numbers that are shorter are left to the library: 256 bytes are some ten points.
constexpr size_t kLeastListBytes = 256;

/// Of documents that include others, below each other.
constexpr size_t kIncludeDepth = 16;

/// The number of all documents.
constexpr size_t kMostDocuments = 1000;

/// Reads a scene's document and those that it includes.
class SceneReader {
 public:
  /// `least_list_bytes`: lists of numbers of so many are read apart; none: all values are YAML's.
  SceneReader(const LoadOptions& options, std::optional<size_t> least_list_bytes)
      : options_(options), least_list_bytes_(least_list_bytes) {}

  /// `outline`: the text's, or none to read it whole.
  SceneDescription read(std::string_view text, const std::string& path, std::optional<YamlOutline> outline) {
    scene().materials.emplace_back("default");
    read_document(text, std::move(outline), path, 0);
    shared_.problems.throw_if_any();
    return std::move(scene());
  }
  /// True if a list was to be read apart, and nobody read it.
  bool has_unread_lists() const { return has_unread_lists_; }
  /// Of a document, if lists are to be read apart and it has some.
  std::optional<YamlOutline> outline(std::string_view text) const {
    std::optional<YamlOutline> found;
    if (least_list_bytes_) found = outline_of(text, *least_list_bytes_);
    if (found && found->is_empty()) found.reset();
    return found;
  }

 private:
  SceneDescription& scene() { return shared_.description; }

  void read_document(std::string_view text, std::optional<YamlOutline> outline, const std::string& path,
                     size_t depth) {
    count_opened(options_.progress, text.size());
    YamlBudget budget;
    budget.file = static_cast<uint32_t>(scene().files.size());
    budget.stop = options_.stop;
    budget.progress = options_.progress;
    budget.outline = outline ? &*outline : nullptr;
    scene().files.push_back(path);
    YAML::Node root;
    try {
      StoppableText buffer(outline ? std::string_view(outline->text()) : text, budget.stop, budget.progress);
      std::istream in(&buffer);
      root = YAML::Load(in);
    } catch (const YAML::ParserException& e) {
      throw InputError({path, e.mark.line + 1, e.mark.column + 1},
                       "not valid YAML: " + e.msg + advice_on_yaml(text, e.mark.line, e.msg));
    } catch (const YAML::Exception& e) {
      throw InputError({path}, std::string("not valid YAML: ") + e.what());
    }
    YamlDocument document{shared_, std::filesystem::path(path).parent_path().string()};
    YamlMap map(YamlValue(root, depth == 0 ? "the scene" : "the included file", path, budget));
    read_map(map, document, path, depth);
    has_unread_lists_ |= outline && !outline->is_read();
    if (const auto& list = budget.slow_list)
      scene().notes.add(
          scene().source(list->place),
          fmt::format(
              "this list of {} items is read one by one, which takes some 70 times as long as if it held "
              "plain numbers alone, between brackets and without comments and tabs, in a file without "
              "tabs, anchors, tags, block texts (`|`, `>`) and letters beyond ASCII",
              list->items));
  }

  void read_map(YamlMap& map, YamlDocument& document, const std::string& path, size_t depth) {
    const auto read = [&](const char* key, auto step) {
      if (const auto v = map.find(key)) shared_.problems.keep([&] { step(*v); });
    };
    read("include", [&](const YamlValue& v) { read_includes(v, document, path, depth); });
    read("render", [&](const YamlValue& v) { read_render(v); });
    read("view", [&](const YamlValue& v) { read_view(v, scene()); });
    read("background", [&](const YamlValue& v) {
      std::erase_if(scene().spectra, [](const auto& s) { return s.field == SpectralField::background; });
      scene().background = read_color(v, SpectralField::background, scene().spectra);
      scene().environment.reset();
    });
    read("environment", [&](const YamlValue& v) {
      if (map.has("background")) v.fail("give either `background` or `environment`, not both");
      std::erase_if(scene().spectra, [](const auto& s) { return s.field == SpectralField::background; });
      read_environment(v, document);
    });
    read("ambient", [&](const YamlValue& v) {
      std::erase_if(scene().spectra, [](const auto& s) { return s.field == SpectralField::ambient; });
      scene().ambient = read_color(v, SpectralField::ambient, scene().spectra);
    });
    read("frames", [&](const YamlValue& v) { read_frames(v); });
    read("lights", [&](const YamlValue& v) { read_lights(v, document); });
    read("textures", [&](const YamlValue& v) { read_textures(v, document); });
    read("materials", [&](const YamlValue& v) { read_materials(v, document); });
    read("media", [&](const YamlValue& v) { read_media(v, document); });
    YamlNodes nodes(document, options_);
    read("objects", [&](const YamlValue& v) { nodes.read_definitions(v); });
    shared_.problems.keep([&] {
      map.refuse("camera",
                 "the camera is `view: {location: [0, 0, 5], look_at: [0, 0, 0], field_of_view: 45}`");
    });
    if (!has_root_ && (depth == 0 || map.has("scene"))) {
      has_root_ = true;
      scene().objects.push_back({"scene", {}, {}, {map.value().place().file, 1, 1}});
      scene().root = static_cast<uint32_t>(scene().objects.size() - 1);
    }
    // What is only included may be nothing but materials; a scene that includes nothing shows something.
    shared_.problems.keep([&] {
      if (const auto v = map.has("include") || depth > 0 ? map.find("scene") : map.require("scene"))
        nodes.read_children(*v, scene().root);
    });
    shared_.problems.keep([&] { map.finish(); });
  }

  /// Each is read where it is first included; a second time it says nothing new.
  void read_includes(const YamlValue& value, YamlDocument& document, const std::string& path, size_t depth) {
    const std::vector<YamlValue> names = value.is_sequence() ? value.items() : std::vector<YamlValue>{value};
    if (depth == 0) included_.insert(canonical(path));
    open_.push_back(canonical(path));
    for (const YamlValue& name : names) {
      const std::string file = document.path_of(name), whole = canonical(file);
      if (const auto above = std::find(open_.begin(), open_.end(), whole); above != open_.end())
        shared_.problems.keep([&] {
          std::string way;
          for (auto step = above; step != open_.end(); ++step)
            way += std::filesystem::path(*step).filename().string() + " includes ";
          name.fail(
              fmt::format("{}{}: files can't include each other in a circle; put what both need into a "
                          "third one",
                          way, std::filesystem::path(whole).filename().string()));
        });
      if (!included_.insert(whole).second) continue;
      if (const std::string extension = extension_of(file);
          extension != ".yaml" && extension != ".yml" &&
          (find_mesh_format(file) || extension == ".nff" || extension == ".rfp")) {
        shared_.problems.keep([&] {
          name.fail(fmt::format(
              "`include` takes scenes in YAML; {}",
              extension == ".nff" ? "an NFF file is a scene of its own, which is rendered alone"
              : extension == ".rfp"
                  ? fmt::format("compiled objects are `scene: [{{objects: {}}}]`", name.text())
                  : fmt::format("a model is shown by `scene: [{{mesh: {{file: {}}}}}]`", name.text())));
        });
        continue;
      }
      if (depth + 1 > kIncludeDepth)
        name.fail(fmt::format("files include each other more than {} deep", kIncludeDepth));
      if (included_.size() > kMostDocuments)
        name.fail(fmt::format("a scene includes no more than {} files", kMostDocuments - 1));
      shared_.problems.keep([&] {
        std::string text;
        try {
          text = read_file(file, limits::kYamlFileBytes, options_.stop);
        } catch (const IoError& e) {
          name.fail(e.what());
        }
        read_document(text, outline(text), file, depth + 1);
      });
    }
    open_.pop_back();
  }
  static std::string canonical(const std::string& path) {
    std::error_code ignored;
    return std::filesystem::weakly_canonical(path, ignored).string();
  }

  /// Options of `rayfarm render` by their names; whoever renders knows what they mean.
  void read_render(const YamlValue& value) {
    for (const auto& [key, v] : value.entries()) {
      std::string name = key.text(), words;
      std::replace(name.begin(), name.end(), '_', '-');
      if (v.is_map()) v.fail("a value was expected, as the command line takes it");
      const bool is_several = name == "size" || name == "subpixels" || name == "crop";
      if (v.is_sequence() && !is_several) v.fail(fmt::format("`{}` takes one value", name));
      const std::vector<YamlValue> items = v.is_sequence() ? v.items() : std::vector<YamlValue>{v};
      for (const YamlValue& item : items) {
        // --size 640x480, but --colour-nodes 450,550
        const char* separator = name == "size" || name == "subpixels" ? "x" : ",";
        words += (words.empty() ? "" : separator) + item.text();
      }
      std::erase_if(scene().render, [&](const RenderChoice& choice) {
        return choice.name == name && choice.place.file != key.place().file;  // of a file that is included
      });
      for (const RenderChoice& choice : scene().render)
        if (choice.name == name) key.fail(fmt::format("`{}` stands twice in render; remove one", name));
      scene().render.push_back({name, words, v.place()});
    }
  }

  void read_frames(const YamlValue& value) {
    const std::vector<YamlValue> range = value.items();
    if (range.size() != 2) value.fail("frames is [first, last]");
    const int first = range[0].whole_number_in(0, 9'999'999);
    scene().frames = {first, range[1].whole_number_in(first, 9'999'999)};
    scene().has_own_frames = true;
  }

  void read_lights(const YamlValue& value, YamlDocument& document) {
    for (const YamlValue& item : value.items()) {
      shared_.problems.keep([&] { scene().lights.push_back(read_light(item, document, scene().spectra)); });
      if (scene().lights.size() > limits::kLights) item.fail("too many lights");
    }
  }

  // What is wrong has a name all the same, so that those who use it are not wrong, too.
  void read_textures(const YamlValue& value, YamlDocument& document) {
    for (const auto& [key, v] : value.entries())
      shared_.problems.keep([&, &key = key, &v = v] {
        TextureDescription texture;
        texture.name = key.text();
        shared_.problems.keep([&] { texture = read_texture(key.text(), v, document); });
        shared_.textures.define(key, static_cast<uint32_t>(scene().textures.size()));
        scene().textures.push_back(std::move(texture));
      });
  }

  void read_materials(const YamlValue& value, YamlDocument& document) {
    for (const auto& [key, v] : value.entries())
      shared_.problems.keep([&, &key = key, &v = v] {
        MaterialDescription material(key.text());
        shared_.problems.keep([&] { material = read_material(key.text(), v, document); });
        shared_.materials.define(key, static_cast<uint32_t>(scene().materials.size()));
        scene().materials.push_back(std::move(material));
      });
  }

  const LoadOptions& options_;
  std::optional<size_t> least_list_bytes_;
  YamlScene shared_;
  std::set<std::string> included_;
  std::vector<std::string> open_;  ///< those that include others, each the one behind it
  bool has_root_ = false, has_unread_lists_ = false;
};

}  // namespace

SceneDescription read_yaml_whole(std::string_view text, const std::string& path, const LoadOptions& options) {
  return SceneReader(options, std::nullopt).read(text, path, std::nullopt);
}

std::optional<SceneDescription> read_yaml_outline(std::string_view text, const std::string& path,
                                                  size_t least_bytes, const LoadOptions& options) {
  SceneReader reader(options, least_bytes);
  std::optional<YamlOutline> outline = reader.outline(text);
  // What a file includes may have lists where it has none.
  if (!outline && text.find("include") == std::string_view::npos) return std::nullopt;
  try {
    SceneDescription scene = reader.read(text, path, std::move(outline));
    if (!reader.has_unread_lists()) return scene;
  } catch (const InputError&) {  // the whole text is read for what is to be told of it
  }
  if (options.progress) options.progress->done = options.progress->total.load();
  return std::nullopt;
}

SceneDescription load_yaml_scene(const std::string& path, const LoadOptions& options) {
  const std::string text = read_file(path, limits::kYamlFileBytes, options.stop);
  if (auto scene = read_yaml_outline(text, path, kLeastListBytes, options)) return std::move(*scene);
  return read_yaml_whole(text, path, options);
}

}  // namespace rayfarm
