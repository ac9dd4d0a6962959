#include "common/description/formats/yaml_nodes.h"

#include <algorithm>

#include "common/description/describe_part.h"
#include "common/description/formats/mesh_loaders.h"
#include "common/description/formats/yaml_curves.h"
#include "common/description/formats/yaml_materials.h"
#include "common/description/formats/yaml_shapes.h"
#include "common/description/formats/yaml_structures.h"
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

/// What a mesh's file added to an object, and the objects that it made.
template <typename Visitor>
void visit_added(SceneDescription& scene, uint32_t object, size_t first_primitive, size_t first_object,
                 Visitor visit) {
  std::vector<PrimitiveDescription>& own = scene.objects[object].primitives;
  for (size_t i = first_primitive; i < own.size(); ++i) visit(own[i]);
  for (size_t i = first_object; i < scene.objects.size(); ++i)
    for (PrimitiveDescription& primitive : scene.objects[i].primitives) visit(primitive);
}

}  // namespace

void YamlNodes::read_definitions(const YamlValue& value) {
  const auto entries = value.entries();
  std::vector<uint32_t> ids;
  for (const auto& [key, v] : entries) {
    ids.push_back(add_object(key.text(), key.place()));
    document_.shared.objects.define(key, ids.back());
  }
  for (size_t i = 0; i < entries.size(); ++i) {
    const YamlValue& definition = entries[i].second;
    if (definition.is_sequence()) {
      read_children(definition, ids[i]);
    } else {
      document_.shared.problems.keep([&] { read_node(definition, ids[i], {}, 0); });
    }
  }
}

/// The material with zones of that size, which is one of its own: primitives know no more than that.
uint32_t YamlNodes::zoned(uint32_t material, float zone_size) {
  if (zone_size == 0) return material;
  const auto [found, is_new] = document_.shared.zoned_materials.try_emplace(
      {material, zone_size}, static_cast<uint32_t>(scene_.materials.size()));
  if (is_new) {
    MaterialDescription copy = scene_.materials[material];
    copy.zone_size = zone_size;
    scene_.materials.push_back(std::move(copy));
  }
  return found->second;
}

void YamlNodes::read_children(const YamlValue& list, uint32_t object, const Inherited& inherited,
                              size_t depth) {
  for (const YamlValue& item : list.items())
    document_.shared.problems.keep([&] { read_node(item, object, inherited, depth); });
}

/// One entry of an object: a shape, a group or a use of a named object, perhaps with a material and a
/// transform.
void YamlNodes::read_node(const YamlValue& value, uint32_t object, Inherited inherited, size_t depth) {
  if (depth > limits::kNestingDepth)
    value.fail(fmt::format("objects are nested more than {} deep", limits::kNestingDepth));
  YamlMap map(value);
  const auto own_material = map.find("material");
  if (own_material) inherited.material = find_material(*own_material, document_);
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
    scene_.notes.add(scene_.source(own_material->place()), "a light has no material: `color` is its colour");
}

/// To a mesh, whose faces may have materials of their own.
void YamlNodes::give_zone_size(PrimitiveDescription& primitive, float zone_size) {
  primitive.material = zoned(primitive.material, zone_size);
  if (auto* mesh = std::get_if<MeshShape>(&primitive.shape)) {
    for (uint32_t& material : mesh->materials) material = zoned(material, zone_size);
    for (uint32_t& material : mesh->polygons.materials) material = zoned(material, zone_size);
  }
}

uint32_t YamlNodes::add_object(const std::string& name, const Place& place) {
  if (scene_.objects.size() >= limits::kObjects)
    throw InputError(scene_.source(place), "the scene has too many objects");
  scene_.objects.push_back({name, {}, {}, place});
  return static_cast<uint32_t>(scene_.objects.size() - 1);
}

void YamlNodes::read_content(YamlMap& map, const YamlValue& value, uint32_t target,
                             const Inherited& inherited, const std::optional<YamlValue>& own_material,
                             size_t depth) {
  int contents = 0;
  for (const auto& [key, read] : yaml_shapes())
    if (auto v = map.find(key)) {
      ++contents;
      for (Shape& shape : read(*v))
        scene_.objects[target].primitives.push_back(
            {std::move(shape), zoned(inherited.material, inherited.zone_size), v->place()});
    }
  const auto replaces = map.find("override");
  if (replaces && !map.has("mesh"))
    replaces->fail("`override` belongs to a `mesh`, whose file has materials of its own");
  if (auto v = map.find("mesh")) {
    ++contents;
    read_mesh(*v, replaces, target, inherited, own_material);
  }
  if (auto v = map.find("light")) {
    ++contents;
    LightDescription& light = scene_.objects[target].lights.emplace_back();
    light.light = read_light(*v, document_, light.spectra);
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
    value.fail(contents == 0
                   ? fmt::format("an object needs one of: {}mesh, light, group, use", words)
                   : "an object can hold only one shape, light, group or use; make each an entry of its own");
  }
}

uint32_t YamlNodes::find_object(const YamlValue& value) const {
  const bool is_file = extension_of(value.text()) == ".rfp";
  return document_.shared.objects.find(value, is_file ? "; a file is named so: `use: {file: part.rfp}`" : "");
}

/// A file is read once however often it is used.
uint32_t YamlNodes::read_part_file(const YamlValue& value) {
  YamlMap map(value);
  const YamlValue file = map.require("file");
  map.finish();
  const std::string path = document_.path_of(file);
  if (extension_of(path) != ".rfp")
    file.fail(
        "compiled objects stand in an .rfp file: `rayfarm compile part.yaml -o part.rfp` makes one; a mesh "
        "is "
        "`mesh: {file: name.obj}`");
  std::map<std::string, uint32_t>& known = document_.shared.part_files;
  const auto found = known.find(path);
  if (found != known.end()) return found->second;
  try {
    known[path] = add_part_file(scene_, path, value.place(), value.stop());
    scene_.files.push_back(path);
    return known[path];
  } catch (const IoError& e) {
    file.fail(e.what());
  }
}

bool YamlNodes::has_override(const std::optional<YamlValue>& of_node, YamlMap& mesh,
                             const Inherited& inherited) {
  bool is_said = false;
  for (const std::optional<YamlValue>& v : {of_node, mesh.find("override")})
    if (v && v->boolean()) {
      is_said = true;
      if (inherited.material == 0)
        v->fail("`override` puts a `material` of the scene in place of the file's; give that, too");
    }
  return is_said;
}

void YamlNodes::read_mesh(const YamlValue& value, const std::optional<YamlValue>& replaces, uint32_t object,
                          const Inherited& inherited, const std::optional<YamlValue>& own_material) {
  YamlMap map(value);
  const YamlValue file = map.require("file");
  const bool has_smoothing = map.has("smooth");
  const Smoothing smoothing = read_smoothing(map, Smoothing::flat);
  double crease = 0;
  if (auto v = map.find("crease")) {
    if (has_smoothing && smoothing == Smoothing::flat)
      v->fail("`crease` belongs to a smooth mesh; leave it out of a flat one");
    crease = v->number_in(1, 179);
  }
  const bool is_replaced = has_override(replaces, map, inherited);
  map.finish();
  const std::string path = document_.path_of(file);
  const MeshFormat* format = find_mesh_format(path);
  if (!format) file.fail(fmt::format("a mesh is read from {}; export it as one", mesh_extensions()));
  // What came as an object of its own is used again.
  uint32_t& known =
      document_.shared.mesh_files
          .try_emplace({path, inherited.material, has_smoothing ? std::optional(smoothing) : std::nullopt,
                        crease, is_replaced, inherited.zone_size},
                       kNone)
          .first->second;
  if (known != kNone) {
    scene_.objects[object].children.push_back({known, {}, value.place()});
    return;
  }
  const size_t first_object = scene_.objects.size(), first_child = scene_.objects[object].children.size(),
               first_primitive = scene_.objects[object].primitives.size();
  try {
    format->load(scene_, object, {path, inherited.material, smoothing, value.place(), has_smoothing, crease},
                 options_);
  } catch (const IoError& e) {
    file.fail(e.what());
  }
  if (is_replaced)
    visit_added(scene_, object, first_primitive, first_object, [&](PrimitiveDescription& primitive) {
      primitive.material = inherited.material;
      if (auto* mesh = std::get_if<MeshShape>(&primitive.shape))
        mesh->materials = mesh->polygons.materials = {};
    });
  const ObjectDescription& made = scene_.objects[object];
  if (made.primitives.size() == first_primitive && made.children.size() == first_child + 1)
    known = made.children.back().object;
  if (own_material) {
    bool is_used = false;
    visit_added(scene_, object, first_primitive, first_object, [&](const PrimitiveDescription& primitive) {
      is_used |= has_material(primitive, inherited.material);
    });
    if (!is_used)
      scene_.notes.add(
          scene_.source(own_material->place()),
          fmt::format(
              "{} is not used: the mesh's file gives all faces their materials; "
              "`override: true` puts this one in their place",
              own_material->is_map() ? "this material" : fmt::format("material '{}'", own_material->text())));
  }
  if (inherited.zone_size != 0)
    visit_added(scene_, object, first_primitive, first_object,
                [&](PrimitiveDescription& primitive) { give_zone_size(primitive, inherited.zone_size); });
}

}  // namespace rayfarm
