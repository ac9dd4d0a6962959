// Rayfarm's scene format. scenes/README.md is its manual.
#include <filesystem>
#include <istream>
#include <map>
#include <numbers>

#include "common/description/formats/scene_loaders.h"
#include "common/description/formats/stoppable_text.h"
#include "common/description/formats/yaml_materials.h"
#include "common/description/formats/yaml_reader.h"
#include "common/description/formats/yaml_textures.h"
#include "common/files/read_file.h"
#include "common/image/image_file.h"
#include "common/math/portable_math.h"

namespace rayfarm {
namespace {

Vec4 quaternion(const Vec3& axis, double degrees) {
  const double half = degrees * (std::numbers::pi / 360);
  return {normalized(axis) * portable_sin(half), portable_cos(half)};
}

/// A constant, or a map `frame: value`.
template <typename Read>
Curve read_curve(const YamlValue& value, Interpolation interpolation, Read read) {
  Curve curve;
  curve.interpolation = interpolation;
  if (!value.is_map()) {
    curve.frames = {0};
    curve.values = {read(value)};
    return curve;
  }
  std::map<double, Vec4> keys;
  for (const auto& [frame, v] : value.entries()) {
    const YamlValue& key = frame;
    double number = 0;
    try {
      number = key.number();
    } catch (const InputError&) {
      key.fail(fmt::format("{} is either one value or a map `frame: value`; '{}' is not a frame number",
                           value.what(), key.text().substr(0, 40)));
    }
    if (!keys.emplace(number, read(v)).second) key.fail(fmt::format("frame {} stands twice", number));
    if (keys.size() > limits::kKeys) key.fail("too many keys");
  }
  if (keys.empty()) value.fail(fmt::format("{} has no keys", value.what()));
  for (const auto& [frame, v] : keys) {
    curve.frames.push_back(frame);
    curve.values.push_back(v);
  }
  return curve;
}

Vec4 read_point(const YamlValue& v) {
  return {v.vector(), 0};
}
Vec4 read_direction(const YamlValue& v) {
  return {v.direction(), 0};
}
Vec4 read_number(const YamlValue& v) {
  return {v.number(), 0, 0, 0};
}
Vec4 read_scale(const YamlValue& v) {
  const Vec3 s = v.is_sequence() ? v.vector() : Vec3(v.number());
  if (s.x == 0 || s.y == 0 || s.z == 0) v.fail("a scale must not be 0: it would flatten the object");
  return {s, 0};
}
Vec4 read_orientation(const YamlValue& v) {
  YamlMap map(v);
  const Vec3 axis = map.require("axis").direction();
  const double degrees = map.require("degrees").number();
  map.finish();
  return quaternion(axis, degrees);
}

Affine read_matrix(const YamlValue& v) {
  const std::vector<double> m = v.numbers();
  if (m.size() != 12 && m.size() != 16)
    v.fail("a matrix has 12 numbers (three rows of four) or 16 (four rows)");
  if (m.size() == 16 && (m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] != 1))
    v.fail("the last row of a matrix must be 0, 0, 0, 1: objects are moved without perspective");
  Affine a;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      a.linear[column][row] = m[static_cast<size_t>(4 * row + column)];
    a.translation[row] = m[static_cast<size_t>(4 * row + 3)];
  }
  if (glm::determinant(a.linear) == 0) v.fail("the matrix is singular: it would flatten the object");
  return a;
}

class Loader {
 public:
  Loader(const std::string& path, const std::stop_token& stop) : path_(path) { budget_.stop = stop; }

  SceneDescription load() {
    const std::string text = read_file(path_, limits::kYamlFileBytes, budget_.stop);
    scene_.files = {path_};
    YAML::Node document;
    try {
      StoppableText buffer(text, budget_.stop);
      std::istream in(&buffer);
      document = YAML::Load(in);
    } catch (const YAML::ParserException& e) {
      throw InputError({path_, e.mark.line + 1, e.mark.column + 1}, "not valid YAML: " + e.msg);
    } catch (const YAML::Exception& e) {
      throw InputError({path_}, std::string("not valid YAML: ") + e.what());
    }
    YamlMap map(YamlValue(document, "the scene", path_, budget_));
    if (auto v = map.find("view")) read_view(*v);
    if (auto v = map.find("background")) scene_.background = v->color();
    if (auto v = map.find("environment")) {
      if (map.has("background")) v->fail("give either `background` or `environment`, not both");
      read_environment(*v, folder(), scene_);
    }
    if (auto v = map.find("ambient")) scene_.ambient = v->color();
    if (auto v = map.find("frames")) read_frames(*v);
    if (auto v = map.find("lights")) read_lights(*v);
    scene_.materials.emplace_back("default");
    if (auto v = map.find("textures")) read_textures(*v);
    if (auto v = map.find("materials")) read_materials(*v);
    if (auto v = map.find("objects")) read_definitions(*v);
    scene_.objects.push_back({"scene", {}, {}, {0, 1, 1}});
    scene_.root = static_cast<uint32_t>(scene_.objects.size() - 1);
    map.refuse("camera",
               "the camera is `view: {location: [0, 0, 5], look_at: [0, 0, 0], field_of_view: 45}`");
    read_children(map.require("scene"), scene_.root, 0, 0);
    map.finish();
    return std::move(scene_);
  }

 private:
  void read_view(const YamlValue& value) {
    YamlMap map(value);
    ViewDescription& view = scene_.view;
    view.location = read_curve(map.require("location"), Interpolation::linear, read_point);
    const auto direction = map.find("direction"), look_at = map.find("look_at");
    if (direction && look_at) direction->fail("give either `direction` or `look_at`, not both");
    if (!direction && !look_at) value.fail("the view needs `direction` or `look_at`");
    if (direction) view.direction = read_curve(*direction, Interpolation::spherical, read_direction);
    if (look_at) view.look_at = read_curve(*look_at, Interpolation::linear, read_point);
    if (auto v = map.find("up")) view.up = read_curve(*v, Interpolation::spherical, read_direction);
    if (auto v = map.find("field_of_view"))
      view.field_of_view = read_curve(*v, Interpolation::linear, [](const YamlValue& n) {
        const double degrees = n.number();
        if (!(degrees > 0 && degrees < 180)) n.fail("the field of view must be between 0 and 180 degrees");
        return Vec4(degrees, 0, 0, 0);
      });
    if (auto v = map.find("lens")) {
      YamlMap lens(*v);
      view.lens_radius = lens.require("radius").number_in(0, 1e9);
      view.focus = read_curve(lens.require("focus"), Interpolation::linear, [](const YamlValue& n) {
        const double distance = n.number();
        if (!(distance > 0)) n.fail("the distance in focus must be above 0");
        return Vec4(distance, 0, 0, 0);
      });
      lens.finish();
    }
    if (auto v = map.find("aspect")) view.aspect = v->number_in(1e-3, 1e3);
    if (auto v = map.find("resolution")) {
      const std::vector<YamlValue> size = v->items();
      if (size.size() != 2) v->fail("the resolution is [width, height] in pixels");
      view.resolution_px = {size[0].whole_number_in(1, 65536), size[1].whole_number_in(1, 65536)};
    }
    map.finish();
  }

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
      scene_.lights.push_back(read_light(item, folder(), scene_));
      if (scene_.lights.size() > limits::kLights) item.fail("too many lights");
    }
  }

  void read_textures(const YamlValue& value) {
    for (const auto& [key, v] : value.entries())
      scene_.textures.push_back(read_texture(key.text(), v, folder(), scene_));
  }

  void read_materials(const YamlValue& value) {
    for (const auto& [key, v] : value.entries())
      scene_.materials.push_back(read_material(key.text(), v, scene_.textures));
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
        read_children(definition, i, 0, 0);
      } else {
        read_node(definition, i, 0, 0);
      }
    }
  }

  void read_children(const YamlValue& list, uint32_t object, uint32_t material, size_t depth) {
    for (const YamlValue& item : list.items()) read_node(item, object, material, depth);
  }

  /// One entry of an object: a shape, a group or a use of a named object, perhaps with a material and a
  /// transform.
  void read_node(const YamlValue& value, uint32_t object, uint32_t material, size_t depth) {
    if (depth > limits::kNestingDepth)
      value.fail(fmt::format("objects are nested more than {} deep", limits::kNestingDepth));
    YamlMap map(value);
    const auto own_material = map.find("material");
    if (own_material) material = find_material(*own_material);
    std::string name;
    if (auto n = map.find("name")) name = n->text();
    std::vector<TransformStep> transform;
    if (auto t = map.find("transform")) transform = read_transform(*t);

    // A transform or a name makes a node of its own in the object tree; without either the entry joins its
    // parent.
    uint32_t target = object;
    if (!transform.empty() || !name.empty()) {
      target = add_object(name.empty() ? fmt::format("line {}", value.place().line) : name, value.place());
      scene_.objects[object].children.push_back({target, std::move(transform), value.place()});
    }
    read_content(map, value, target, material, depth);
    map.finish();
    if (own_material && map.has("mesh")) note_idle_material(*own_material, material, target);
  }

  /// A mesh whose file gives every face a material needs none.
  void note_idle_material(const YamlValue& value, uint32_t material, uint32_t object) {
    const auto& mesh = std::get<MeshShape>(scene_.objects[object].primitives.back().shape);
    if (std::find(mesh.materials.begin(), mesh.materials.end(), material) == mesh.materials.end())
      scene_.notes.add(
          scene_.source(value.place()),
          fmt::format("material '{}' is not used: the mesh's file gives all faces their materials",
                      value.text()));
  }

  uint32_t add_object(const std::string& name, const Place& place) {
    if (scene_.objects.size() >= limits::kObjects)
      throw InputError(scene_.source(place), "the scene has too many objects");
    scene_.objects.push_back({name, {}, {}, place});
    return static_cast<uint32_t>(scene_.objects.size() - 1);
  }

  void read_content(YamlMap& map, const YamlValue& value, uint32_t target, uint32_t material, size_t depth) {
    using Reader = void (Loader::*)(const YamlValue&, uint32_t, uint32_t);
    static const std::vector<std::pair<std::string, Reader>> kShapes = {
        {"sphere", &Loader::read_sphere},
        {"polygon", &Loader::read_polygon},
        {"box", &Loader::read_box},
        {"cylinder", &Loader::read_cylinder},
        {"cone", &Loader::read_cone},
        {"quadric", &Loader::read_quadric},
        {"triangles", &Loader::read_triangles},
        {"mesh", &Loader::read_mesh}};
    int contents = 0;
    for (const auto& [key, reader] : kShapes)
      if (auto v = map.find(key)) {
        ++contents;
        (this->*reader)(*v, target, material);
      }
    if (auto v = map.find("group")) {
      ++contents;
      read_children(*v, target, material, depth + 1);
    }
    if (auto v = map.find("use")) {
      ++contents;
      const std::string used = v->text();
      const auto found = object_ids_.find(used);
      if (found == object_ids_.end()) v->fail_unknown("object", object_names_);
      scene_.objects[target].children.push_back({found->second, {}, v->place()});
    }
    if (contents != 1) {
      map.finish();  // an unknown key is the likelier mistake
      value.fail(contents == 0
                     ? "an object needs one of: sphere, polygon, triangles, box, cylinder, cone, quadric, "
                       "mesh, group, use"
                     : "an object can hold only one shape, group or use; make each an entry of its own");
    }
  }

  std::vector<TransformStep> read_transform(const YamlValue& value) {
    std::vector<TransformStep> steps;
    const std::vector<YamlValue> items = value.is_sequence() ? value.items() : std::vector<YamlValue>{value};
    for (const YamlValue& item : items) {
      YamlMap map(item);
      const size_t before = steps.size();
      if (auto v = map.find("translate"))
        steps.push_back(
            {TransformKind::translate, read_curve(*v, Interpolation::linear, read_point), {}, {}});
      if (auto v = map.find("scale"))
        steps.push_back({TransformKind::scale, read_curve(*v, Interpolation::linear, read_scale), {}, {}});
      if (auto v = map.find("rotate")) {
        if (!v->is_map())
          v->fail(
              "a rotation is about one axis: `rotate: {axis: [0, 1, 0], degrees: 90}`; for several write a "
              "list of "
              "steps");
        YamlMap rotate(*v);
        TransformStep step{TransformKind::rotate, {}, rotate.require("axis").direction(), {}};
        step.curve = read_curve(rotate.require("degrees"), Interpolation::linear, read_number);
        rotate.finish();
        steps.push_back(step);
      }
      if (auto v = map.find("orient")) {
        YamlMap probe(*v);
        const bool is_constant = probe.has("axis");
        steps.push_back({TransformKind::orient,
                         is_constant ? constant_curve(read_orientation(*v))
                                     : read_curve(*v, Interpolation::spherical_rotation, read_orientation),
                         {},
                         {}});
      }
      if (auto v = map.find("matrix"))
        steps.push_back({TransformKind::matrix, constant_curve(Vec4(0)), {}, read_matrix(*v)});
      map.finish();
      if (steps.size() != before + 1)
        item.fail(
            "each step of a transform is one of: translate, rotate, scale, orient, matrix; write a list of "
            "steps");
    }
    return steps;
  }

  void add(uint32_t object, Shape shape, uint32_t material, const YamlValue& at) {
    scene_.objects[object].primitives.push_back({std::move(shape), material, at.place()});
  }

  void read_sphere(const YamlValue& value, uint32_t object, uint32_t material) {
    YamlMap map(value);
    SphereShape sphere;
    sphere.center = map.require("center").vector();
    sphere.radius = map.require("radius").number();
    map.finish();
    add(object, sphere, material, value);
  }

  void read_cylinder(const YamlValue& value, uint32_t object, uint32_t material) {
    YamlMap map(value);
    ConeShape cone;
    cone.base = map.require("base").vector();
    cone.apex = map.require("top").vector();
    cone.base_radius = cone.apex_radius = map.require("radius").number();
    map.finish();
    add(object, cone, material, value);
  }

  void read_cone(const YamlValue& value, uint32_t object, uint32_t material) {
    YamlMap map(value);
    ConeShape cone;
    cone.base = map.require("base").vector();
    cone.apex = map.require("apex").vector();
    cone.base_radius = map.require("base_radius").number();
    cone.apex_radius = 0;
    if (auto v = map.find("apex_radius")) cone.apex_radius = v->number();
    map.finish();
    add(object, cone, material, value);
  }

  void read_quadric(const YamlValue& value, uint32_t object, uint32_t material) {
    YamlMap map(value);
    QuadricShape quadric;
    const YamlValue coefficients = map.require("coefficients");
    const std::vector<double> c = coefficients.numbers();
    if (c.size() != 10)
      coefficients.fail("a quadric has 10 coefficients: x², y², z², 2xy, 2xz, 2yz, 2x, 2y, 2z, 1");
    std::copy(c.begin(), c.end(), quadric.coefficients.begin());
    if (auto planes = map.find("planes"))
      for (const YamlValue& plane : planes->items()) {
        const std::vector<double> p = plane.numbers();
        if (p.size() != 4) plane.fail("a plane is [nx, ny, nz, d] and keeps the points with n·p <= d");
        quadric.planes.emplace_back(p[0], p[1], p[2], p[3]);
      }
    map.finish();
    add(object, quadric, material, value);
  }

  Smoothing read_smoothing(YamlMap& map, Smoothing fallback) {
    if (auto v = map.find("smooth")) return static_cast<Smoothing>(v->choice({"flat", "phong", "center"}));
    return fallback;
  }

  void read_polygon(const YamlValue& value, uint32_t object, uint32_t material) {
    YamlMap map(value);
    PolygonShape polygon;
    for (const YamlValue& p : map.require("points").items()) polygon.points.push_back(p.vector());
    if (auto normals = map.find("normals"))
      for (const YamlValue& n : normals->items()) polygon.normals.push_back(n.direction());
    if (!polygon.normals.empty() && polygon.normals.size() != polygon.points.size())
      value.fail(fmt::format("the polygon has {} points but {} normals", polygon.points.size(),
                             polygon.normals.size()));
    polygon.smoothing = read_smoothing(map, Smoothing::phong);
    map.finish();
    add(object, polygon, material, value);
  }

  void read_box(const YamlValue& value, uint32_t object, uint32_t material) {
    YamlMap map(value);
    const Vec3 lo = map.require("min").vector(), hi = map.require("max").vector();
    map.finish();
    if (!(lo.x < hi.x && lo.y < hi.y && lo.z < hi.z))
      value.fail("each coordinate of `min` must be below that of `max`");
    const auto corner = [&](int i) {
      return Vec3(i & 1 ? hi.x : lo.x, i & 2 ? hi.y : lo.y, i & 4 ? hi.z : lo.z);
    };
    static constexpr int kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                         {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const auto& face : kFaces) {
      PolygonShape polygon;
      for (const int i : face) polygon.points.push_back(corner(i));
      add(object, polygon, material, value);
    }
  }

  void read_triangles(const YamlValue& value, uint32_t object, uint32_t material) {
    YamlMap map(value);
    MeshShape mesh;
    for (const YamlValue& p : map.require("points").items()) mesh.positions.emplace_back(p.vector());
    for (const YamlValue& t : map.require("triangles").items()) {
      const std::vector<YamlValue> corners = t.items();
      if (corners.size() != 3) t.fail("a triangle is three indices into `points`, counted from 0");
      glm::uvec3 indices;
      for (int k = 0; k < 3; ++k)
        indices[k] = static_cast<uint32_t>(
            corners[static_cast<size_t>(k)].whole_number_in(0, static_cast<int>(mesh.positions.size()) - 1));
      mesh.triangles.push_back(indices);
    }
    if (auto normals = map.find("normals")) {
      for (const YamlValue& n : normals->items()) mesh.normals.emplace_back(n.direction());
      if (mesh.normals.size() != mesh.positions.size())
        value.fail(
            fmt::format("the mesh has {} points but {} normals", mesh.positions.size(), mesh.normals.size()));
      mesh.triangle_normals = mesh.triangles;
    }
    mesh.smoothing = read_smoothing(map, mesh.normals.empty() ? Smoothing::flat : Smoothing::phong);
    map.finish();
    add(object, std::move(mesh), material, value);
  }

  void read_mesh(const YamlValue& value, uint32_t object, uint32_t material) {
    YamlMap map(value);
    const YamlValue file = map.require("file");
    const Smoothing smoothing = read_smoothing(map, Smoothing::flat);
    map.finish();
    const std::filesystem::path path = std::filesystem::path(path_).parent_path() / file.text();
    if (extension_of(path.string()) != ".obj")
      file.fail("a mesh is read from an .obj file; export it as one");
    try {
      scene_.objects[object].primitives.push_back(
          load_obj_mesh(scene_, path.string(), material, smoothing, value.place(), value.stop()));
    } catch (const IoError& e) {
      file.fail(e.what());
    }
  }

  std::string path_;
  YamlBudget budget_;
  SceneDescription scene_;
  std::vector<std::string> material_names_, object_names_;
  std::map<std::string, uint32_t> object_ids_;
};

}  // namespace

SceneDescription load_yaml_scene(const std::string& path, const std::stop_token& stop) {
  return Loader(path, stop).load();
}

}  // namespace rayfarm
