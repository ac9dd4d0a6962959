#include "common/description/formats/model_yaml.h"

#include <fmt/ranges.h>

namespace rayfarm {
namespace {

std::string text_of_vector(const Vec4& v) {
  return fmt::format("[{}, {}, {}]", v.x, v.y, v.z);
}
std::string text_of_number(const Vec4& v) {
  return fmt::format("{}", v.x);
}

/// A value, or one for each key.
template <typename TextOf>
std::string text_of_curve(const Curve& curve, TextOf text_of) {
  if (!curve.is_animated()) return text_of(curve.values.front());
  std::string text = "{";
  for (size_t i = 0; i < curve.frames.size(); ++i)
    text += fmt::format("{}{}: {}", i > 0 ? ", " : "", curve.frames[i], text_of(curve.values[i]));
  return text + "}";
}

/// As a YAML scalar.
std::string quoted(const std::string& text) {
  std::string all = "'";
  for (const char c : text) all += c == '\'' ? std::string("''") : std::string(1, c);
  return all + "'";
}

std::string text_of_view(const ViewDescription& view) {
  const ViewDescription usual;
  std::string text = "view:\n";
  const auto add = [&text](const char* key, const std::string& value) {
    text += fmt::format("  {}: {}\n", key, value);
  };
  add("location", text_of_curve(view.location, text_of_vector));
  if (view.look_at)
    add("look_at", text_of_curve(*view.look_at, text_of_vector));
  else
    add("direction", text_of_curve(view.direction, text_of_vector));
  if (view.up.is_animated() || view.up.values.front() != usual.up.values.front())
    add("up", text_of_curve(view.up, text_of_vector));
  if (view.projection != Projection::perspective)
    add("projection", kProjectionWords[static_cast<size_t>(view.projection)]);
  if (view.projection == Projection::orthographic)
    add("width", text_of_curve(view.width, text_of_number));
  else
    add("field_of_view", text_of_curve(view.field_of_view, text_of_number));
  if (view.shift != usual.shift) add("shift", fmt::format("[{}, {}]", view.shift[0], view.shift[1]));
  if (view.near != usual.near) add("near", fmt::format("{}", view.near));
  if (view.far != usual.far) add("far", fmt::format("{}", view.far));
  if (view.aspect != usual.aspect) add("aspect", fmt::format("{}", view.aspect));
  return text;
}

/// Of a quick look: classical, or the lamp's.
std::string text_of_material(const MaterialDescription& m) {
  if (m.kind == MaterialKind::luminaire) return fmt::format("{{luminaire: {{emission: {}}}}}", m.emission.x);
  std::string text = fmt::format("{{color: {}, ambient: {}, diffuse: {}", m.color.x, m.ambient, m.diffuse);
  if (m.specular > 0) text += fmt::format(", specular: {}, shininess: {}", m.specular, m.shininess);
  return text + "}";
}

/// Of a quick look: a polygon or a sphere.
std::string text_of_shape(const Shape& shape) {
  if (const auto* sphere = std::get_if<SphereShape>(&shape))
    return fmt::format("sphere: {{center: {}, radius: {}}}", text_of_vector(Vec4(sphere->center, 0)),
                       sphere->radius);
  std::vector<std::string> points;
  for (const Vec3& p : std::get<PolygonShape>(shape).points) points.push_back(text_of_vector(Vec4(p, 0)));
  return fmt::format("polygon: {{points: [{}]}}", fmt::join(points, ", "));
}

}  // namespace

std::string yaml_of_model(const SceneDescription& scene, const ModelNode& node) {
  const std::vector<ChildDescription>& children = scene.objects[scene.root].children;
  std::string materials, nodes = "scene:\n  - name: model\n";
  const auto add_material = [&](uint32_t index) {
    const MaterialDescription& m = scene.materials[index];
    materials += fmt::format("  {}: {}\n", m.name, text_of_material(m));
    nodes += fmt::format("    material: {}\n", m.name);
  };
  if (node.material != 0) add_material(node.material);
  if (node.has_z_up)
    nodes +=
        fmt::format("    transform: {{matrix: [{}]}}  # z is up in the file\n", fmt::join(kFromZUp, ", "));
  nodes += fmt::format("    mesh: {{file: {}{}}}\n", quoted(node.file), node.mesh_keys);
  for (size_t i = 1; i < children.size(); ++i) {
    const ObjectDescription& object = scene.objects[children[i].object];
    const PrimitiveDescription& primitive = object.primitives.at(0);
    nodes += fmt::format("  - name: {}\n", object.name);
    add_material(primitive.material);
    nodes += fmt::format("    {}\n", text_of_shape(primitive.shape));
  }
  std::vector<std::string> choices;
  for (const RenderChoice& choice : scene.render)
    choices.push_back(fmt::format("{}: {}", choice.name, choice.value));
  std::string text = "# Written by `rayfarm convert`, to go on from.\n" + text_of_view(scene.view);
  if (!choices.empty()) text += fmt::format("render: {{{}}}\n", fmt::join(choices, ", "));
  if (scene.background != Color(0)) text += fmt::format("background: {}\n", scene.background.x);
  if (!materials.empty()) text += "materials:\n" + materials;
  return text + nodes;
}

}  // namespace rayfarm
