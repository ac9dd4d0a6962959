// Rayfarm's scene format. scenes/README.md is its manual.
#include <filesystem>
#include <istream>
#include <map>

#include "common/description/describe_part.h"
#include "common/description/formats/mesh_loaders.h"
#include "common/description/formats/scene_loaders.h"
#include "common/description/formats/stoppable_text.h"
#include "common/description/formats/yaml_curves.h"
#include "common/description/formats/yaml_materials.h"
#include "common/description/formats/yaml_media.h"
#include "common/description/formats/yaml_reader.h"
#include "common/description/formats/yaml_scene.h"
#include "common/description/formats/yaml_shapes.h"
#include "common/description/formats/yaml_spectra.h"
#include "common/description/formats/yaml_structures.h"
#include "common/description/formats/yaml_textures.h"
#include "common/description/formats/yaml_view.h"
#include "common/files/read_file.h"
#include "common/image/image_file.h"

namespace rayfarm {
namespace {

/// True if some face of a mesh, or a primitive that is none, has the material.
bool has_material(const PrimitiveDescription& primitive, uint32_t material) {
  const auto* mesh = std::get_if<MeshShape>(&primitive.shape);
  if (!mesh) return primitive.material == material;
  const auto has = [&](std::span<const uint32_t> materials, size_t faces) {
    return materials.empty() ? faces > 0 && primitive.material == material
                             : std::find(materials.begin(), materials.end(), material) != materials.end();
  };
  return has(mesh->materials, mesh->triangles.size()) ||
         has(mesh->polygons.materials, mesh->polygons.sides.size());
}

/// Lists of numbers that are shorter are left to the library: 256 bytes are some ten points.
constexpr size_t kLeastListBytes = 256;

class Loader {
 public:
  /// Of a text, or of its outline.
  Loader(std::string_view text, const std::string& path, const LoadOptions& options, YamlOutline* outline)
      : text_(outline ? outline->text() : text), path_(path), options_(options) {
    budget_.stop = options.stop;
    budget_.progress = options.progress;
    budget_.outline = outline;
  }

  SceneDescription load() {
    scene_.files = {path_};
    YAML::Node document;
    try {
      StoppableText buffer(text_, budget_.stop, budget_.progress);
      std::istream in(&buffer);
      document = YAML::Load(in);
    } catch (const YAML::ParserException& e) {
      throw InputError({path_, e.mark.line + 1, e.mark.column + 1}, "not valid YAML: " + e.msg);
    } catch (const YAML::Exception& e) {
      throw InputError({path_}, std::string("not valid YAML: ") + e.what());
    }
    YamlMap map(YamlValue(document, "the scene", path_, budget_));
    if (auto v = map.find("view")) read_view(*v, scene_);
    if (auto v = map.find("background"))
      scene_.background = read_color(*v, SpectralField::background, scene_.spectra);
    if (auto v = map.find("environment")) {
      if (map.has("background")) v->fail("give either `background` or `environment`, not both");
      read_environment(*v, folder(), scene_);
    }
    if (auto v = map.find("ambient")) scene_.ambient = read_color(*v, SpectralField::ambient, scene_.spectra);
    if (auto v = map.find("frames")) read_frames(*v);
    if (auto v = map.find("lights")) read_lights(*v);
    scene_.materials.emplace_back("default");
    if (auto v = map.find("textures")) read_textures(*v);
    if (auto v = map.find("materials")) read_materials(*v);
    if (auto v = map.find("media")) read_media(*v, folder(), scene_);
    if (auto v = map.find("objects")) read_definitions(*v);
    scene_.objects.push_back({"scene", {}, {}, {0, 1, 1}});
    scene_.root = static_cast<uint32_t>(scene_.objects.size() - 1);
    map.refuse("camera",
               "the camera is `view: {location: [0, 0, 5], look_at: [0, 0, 0], field_of_view: 45}`");
    read_children(map.require("scene"), scene_.root, {}, 0);
    map.finish();
    if (const auto& list = budget_.slow_list)
      scene_.notes.add(
          scene_.source(list->place),
          fmt::format(
              "this list of {} items is read one by one, which takes some 70 times as long as if it held "
              "plain numbers alone, between brackets and without comments and tabs, in a file without "
              "tabs, anchors, tags, block texts (`|`, `>`) and letters beyond ASCII",
              list->items));
    return std::move(scene_);
  }

 private:
  void read_frames(const YamlValue& value) {
    const std::vector<YamlValue> range = value.items();
    if (range.size() != 2) value.fail("frames is [first, last]");
    const int first = range[0].whole_number_in(0, 9'999'999);
    scene_.frames = {first, range[1].whole_number_in(first, 9'999'999)};
  }

  /// In which the files that the scene names are looked for.
  std::string folder() const { return std::filesystem::path(path_).parent_path().string(); }

  void read_lights(const YamlValue& value) {
    for (const YamlValue& item : value.items()) {
      scene_.lights.push_back(read_light(item, folder(), scene_, scene_.spectra));
      if (scene_.lights.size() > limits::kLights) item.fail("too many lights");
    }
  }

  void read_textures(const YamlValue& value) {
    for (const auto& [key, v] : value.entries())
      scene_.textures.push_back(read_texture(key.text(), v, folder(), scene_));
  }

  void read_materials(const YamlValue& value) {
    for (const auto& [key, v] : value.entries())
      scene_.materials.push_back(read_material(key.text(), v, folder(), scene_));
    for (const MaterialDescription& m : scene_.materials) material_names_.push_back(m.name);
  }

  uint32_t find_material(const YamlValue& value) {
    if (value.is_map())
      value.fail(
          "`material` names one that is defined under `materials`: `materials: {red: {color: [1, 0, 0]}}` at "
          "the top of the file, and `material: red` here");
    const std::string name = value.text();
    for (size_t i = 1; i < material_names_.size(); ++i)
      if (material_names_[i] == name) return static_cast<uint32_t>(i);
    const std::vector<std::string> defined(material_names_.begin() + (material_names_.empty() ? 0 : 1),
                                           material_names_.end());
    value.fail_unknown("material", defined);
  }

  /// Names first, contents after, so that a definition may use one that stands further down.
  void read_definitions(const YamlValue& value) {
    const auto entries = value.entries();
    for (const auto& [key, v] : entries) {
      if (!object_ids_.emplace(key.text(), static_cast<uint32_t>(scene_.objects.size())).second)
        key.fail(fmt::format("object '{}' is defined twice", key.text()));
      scene_.objects.push_back({key.text(), {}, {}, key.place()});
      object_names_.push_back(key.text());
    }
    for (uint32_t i = 0; i < entries.size(); ++i) {
      const YamlValue& definition = entries[i].second;
      if (definition.is_sequence()) {
        read_children(definition, i, {}, 0);
      } else {
        read_node(definition, i, {}, 0);
      }
    }
  }

  /// What a node hands down to those in it.
  struct Inherited {
    uint32_t material = 0;
    uint32_t structure = kNone;
    float zone_size = 0;
  };

  /// The material with zones of that size, which is one of its own: primitives know no more than that.
  uint32_t zoned(uint32_t material, float zone_size) {
    if (zone_size == 0) return material;
    const auto [found, is_new] =
        zoned_materials_.try_emplace({material, zone_size}, static_cast<uint32_t>(scene_.materials.size()));
    if (is_new) {
      MaterialDescription copy = scene_.materials[material];
      copy.zone_size = zone_size;
      scene_.materials.push_back(std::move(copy));
    }
    return found->second;
  }

  void read_children(const YamlValue& list, uint32_t object, const Inherited& inherited, size_t depth) {
    for (const YamlValue& item : list.items()) read_node(item, object, inherited, depth);
  }

  /// One entry of an object: a shape, a group or a use of a named object, perhaps with a material and a
  /// transform.
  void read_node(const YamlValue& value, uint32_t object, Inherited inherited, size_t depth) {
    if (depth > limits::kNestingDepth)
      value.fail(fmt::format("objects are nested more than {} deep", limits::kNestingDepth));
    YamlMap map(value);
    const auto own_material = map.find("material");
    if (own_material) inherited.material = find_material(*own_material);
    std::string name;
    if (auto n = map.find("name")) name = n->text();
    ChildDescription child;
    child.place = value.place();
    if (auto t = map.find("transform")) child.transform = read_transform(*t);
    if (auto v = map.find("visible")) child.visible = read_curve(*v, Interpolation::step, read_truth);
    const auto own_structure = map.find("structure");
    if (own_structure) {
      inherited.structure = static_cast<uint32_t>(scene_.structures.size());
      scene_.structures.push_back(read_structure(*own_structure));
    }

    const auto own_bound = map.find("bound");
    const auto own_zones = map.find("zones");
    if (own_zones) inherited.zone_size = static_cast<float>(own_zones->number_in(1e-12, 1e12));

    // What can move, come and go, has a name, a structure or a bounding volume is a node of its own in the
    // object tree; any other entry joins its parent.
    uint32_t target = object;
    if (!child.transform.empty() || child.visible || !name.empty() || own_structure || own_bound) {
      target = add_object(name.empty() ? fmt::format("line {}", value.place().line) : name, value.place());
      scene_.objects[target].structure = inherited.structure;
      if (own_bound) {
        scene_.objects[target].bound = read_bound(*own_bound);
        scene_.objects[target].bound_place = own_bound->place();
      }
      child.object = target;
      scene_.objects[object].children.push_back(std::move(child));
    }
    read_content(map, value, target, inherited, own_material, depth);
    map.finish();
    if (own_material && map.has("use"))
      scene_.notes.add(scene_.source(own_material->place()),
                       "`material` has no effect on what `use` names, which has materials of its own");
    if (own_zones && map.has("use"))
      scene_.notes.add(scene_.source(own_zones->place()),
                       "`zones` has no effect on what `use` names; it stands where that is defined");
    if (own_zones && map.has("light"))
      scene_.notes.add(scene_.source(own_zones->place()), "a light has no zones");
    if (own_material && map.has("light"))
      scene_.notes.add(scene_.source(own_material->place()),
                       "a light has no material: `color` is its colour");
  }

  /// What a mesh's file added to an object, and the objects that it made.
  template <typename Visitor>
  void visit_added(uint32_t object, size_t first_primitive, size_t first_object, Visitor visit) {
    std::vector<PrimitiveDescription>& own = scene_.objects[object].primitives;
    for (size_t i = first_primitive; i < own.size(); ++i) visit(own[i]);
    for (size_t i = first_object; i < scene_.objects.size(); ++i)
      for (PrimitiveDescription& primitive : scene_.objects[i].primitives) visit(primitive);
  }

  /// To a mesh, whose faces may have materials of their own.
  void give_zone_size(PrimitiveDescription& primitive, float zone_size) {
    primitive.material = zoned(primitive.material, zone_size);
    if (auto* mesh = std::get_if<MeshShape>(&primitive.shape)) {
      for (uint32_t& material : mesh->materials) material = zoned(material, zone_size);
      for (uint32_t& material : mesh->polygons.materials) material = zoned(material, zone_size);
    }
  }

  uint32_t add_object(const std::string& name, const Place& place) {
    if (scene_.objects.size() >= limits::kObjects)
      throw InputError(scene_.source(place), "the scene has too many objects");
    scene_.objects.push_back({name, {}, {}, place});
    return static_cast<uint32_t>(scene_.objects.size() - 1);
  }

  void read_content(YamlMap& map, const YamlValue& value, uint32_t target, const Inherited& inherited,
                    const std::optional<YamlValue>& own_material, size_t depth) {
    int contents = 0;
    for (const auto& [key, read] : yaml_shapes())
      if (auto v = map.find(key)) {
        ++contents;
        for (Shape& shape : read(*v))
          scene_.objects[target].primitives.push_back(
              {std::move(shape), zoned(inherited.material, inherited.zone_size), v->place()});
      }
    if (auto v = map.find("mesh")) {
      ++contents;
      read_mesh(*v, map, target, inherited, own_material);
    }
    if (auto v = map.find("light")) {
      ++contents;
      LightDescription& light = scene_.objects[target].lights.emplace_back();
      light.light = read_light(*v, folder(), scene_, light.spectra);
      light.place = v->place();
    }
    if (auto v = map.find("group")) {
      ++contents;
      read_children(*v, target, inherited, depth + 1);
    }
    if (auto v = map.find("use")) {
      ++contents;
      const uint32_t used = v->is_map() ? read_part_file(*v) : find_object(*v);
      scene_.objects[target].children.push_back({used, {}, v->place()});
    }
    if (contents != 1) {
      map.finish();  // an unknown key is the likelier mistake
      std::string words;
      for (const YamlShape& shape : yaml_shapes()) words += fmt::format("{}, ", shape.key);
      value.fail(
          contents == 0
              ? fmt::format("an object needs one of: {}mesh, light, group, use", words)
              : "an object can hold only one shape, light, group or use; make each an entry of its own");
    }
  }

  uint32_t find_object(const YamlValue& value) const {
    const auto found = object_ids_.find(value.text());
    if (found == object_ids_.end())
      value.fail_unknown(
          "object", object_names_,
          extension_of(value.text()) == ".rfp" ? "; a file is named so: `use: {file: part.rfp}`" : "");
    return found->second;
  }

  /// A file is read once however often it is used.
  uint32_t read_part_file(const YamlValue& value) {
    YamlMap map(value);
    const YamlValue file = map.require("file");
    map.finish();
    const std::string path = (std::filesystem::path(folder()) / file.text()).string();
    if (extension_of(path) != ".rfp")
      file.fail(
          "compiled objects stand in an .rfp file: `rayfarm compile part.yaml -o part.rfp` makes one; a mesh "
          "is "
          "`mesh: {file: name.obj}`");
    const auto found = part_files_.find(path);
    if (found != part_files_.end()) return found->second;
    try {
      part_files_[path] = add_part_file(scene_, path, value.place(), value.stop());
      scene_.files.push_back(path);
      return part_files_[path];
    } catch (const IoError& e) {
      file.fail(e.what());
    }
  }

  /// True if the node's material replaces those of its mesh's file; said there or in the mesh.
  static bool has_override(YamlMap& node, YamlMap& mesh, const Inherited& inherited) {
    bool is_said = false;
    for (YamlMap* map : {&node, &mesh})
      if (auto v = map->find("override"); v && v->boolean()) {
        is_said = true;
        if (inherited.material == 0)
          v->fail("`override` puts a `material` of the scene in place of the file's; give that, too");
      }
    return is_said;
  }

  void read_mesh(const YamlValue& value, YamlMap& node, uint32_t object, const Inherited& inherited,
                 const std::optional<YamlValue>& own_material) {
    YamlMap map(value);
    const YamlValue file = map.require("file");
    const bool has_smoothing = map.has("smooth");
    const Smoothing smoothing = read_smoothing(map, Smoothing::flat);
    const bool is_replaced = has_override(node, map, inherited);
    map.finish();
    const std::string path = (std::filesystem::path(folder()) / file.text()).string();
    const MeshFormat* format = find_mesh_format(path);
    if (!format) file.fail(fmt::format("a mesh is read from {}; export it as one", mesh_extensions()));
    const size_t first_object = scene_.objects.size(),
                 first_primitive = scene_.objects[object].primitives.size();
    try {
      format->load(scene_, object, {path, inherited.material, smoothing, value.place(), has_smoothing},
                   options_);
    } catch (const IoError& e) {
      file.fail(e.what());
    }
    if (is_replaced)
      visit_added(object, first_primitive, first_object, [&](PrimitiveDescription& primitive) {
        primitive.material = inherited.material;
        if (auto* mesh = std::get_if<MeshShape>(&primitive.shape))
          mesh->materials = mesh->polygons.materials = {};
      });
    if (own_material) {
      bool is_used = false;
      visit_added(object, first_primitive, first_object, [&](const PrimitiveDescription& primitive) {
        is_used |= has_material(primitive, inherited.material);
      });
      if (!is_used)
        scene_.notes.add(
            scene_.source(own_material->place()),
            fmt::format("material '{}' is not used: the mesh's file gives all faces their materials; "
                        "`override: true` puts this one in their place",
                        own_material->text()));
    }
    if (inherited.zone_size != 0)
      visit_added(object, first_primitive, first_object,
                  [&](PrimitiveDescription& primitive) { give_zone_size(primitive, inherited.zone_size); });
  }

  std::string_view text_;
  std::string path_;
  LoadOptions options_;
  YamlBudget budget_;
  SceneDescription scene_;
  std::vector<std::string> material_names_, object_names_;
  std::map<std::string, uint32_t> object_ids_, part_files_;
  std::map<std::pair<uint32_t, float>, uint32_t> zoned_materials_;
};

}  // namespace

SceneDescription read_yaml_whole(std::string_view text, const std::string& path, const LoadOptions& options) {
  count_opened(options.progress, text.size());
  return Loader(text, path, options, nullptr).load();
}

std::optional<SceneDescription> read_yaml_outline(std::string_view text, const std::string& path,
                                                  size_t least_bytes, const LoadOptions& options) {
  std::optional<YamlOutline> outline = outline_of(text, least_bytes);
  if (!outline || outline->is_empty()) return std::nullopt;
  count_opened(options.progress, text.size());
  try {
    SceneDescription scene = Loader(text, path, options, &*outline).load();
    if (outline->is_read()) return scene;
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
