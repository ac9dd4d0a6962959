#include "common/description/formats/mesh_scene.h"

#include "common/description/formats/mesh_loaders.h"
#include "common/description/formats/scene_loaders.h"
#include "common/description/quick_look.h"
#include "common/description/scene_bounds.h"
#include "common/image/image_file.h"

namespace rayfarm {
namespace {

/// Edges between faces that meet at a larger angle, in degrees, stay sharp where a file says nothing of it.
constexpr double kCrease = 40;

/// Of programs for machine parts, whose files are STL, z is up.
bool has_z_up(const std::string& path) {
  return extension_of(path) == ".stl";
}

/// Rows of x y z 1: z becomes y, and y points away from the viewer. Without a rounding error.
constexpr double kFromZUp[] = {1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0};

struct MeshScene {
  SceneDescription scene;
  QuickLook look;
  bool is_coloured = false;
};

MeshScene load_model(const std::string& path, const LoadOptions& options) {
  MeshScene result;
  SceneDescription& scene = result.scene;
  scene.materials.emplace_back("default");
  scene.objects = {{"scene", {}, {}, {}}, {"model", {}, {}, {}}};
  ChildDescription model{1, {}, {}};
  if (has_z_up(path)) {
    TransformStep& turn = model.transform.emplace_back();
    turn.kind = TransformKind::matrix;
    turn.curve = constant_curve(Vec4(0));
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) turn.matrix.linear[column][row] = kFromZUp[4 * row + column];
  }
  scene.objects[0].children.push_back(std::move(model));
  scene.materials.push_back(quick_look_material(false));
  const MeshRequest request{path, 1, Smoothing::flat, {}, false, kCrease};
  find_mesh_format(path)->load(scene, 1, request, options);
  for (const ObjectDescription& object : scene.objects)
    for (const PrimitiveDescription& primitive : object.primitives)
      if (const auto* mesh = std::get_if<MeshShape>(&primitive.shape))
        result.is_coloured |= !mesh->colors.empty();
  scene.materials[1] = quick_look_material(result.is_coloured);
  const Box bounds = bounds_of_meshes(scene);
  if (bounds.is_empty()) throw InputError({path}, "there is nothing in it to look at");
  result.look = make_quick_look(bounds);
  return result;
}

}  // namespace

SceneDescription load_mesh_scene(const std::string& path, const LoadOptions& options) {
  MeshScene model = load_model(path, options);
  add_quick_look(model.scene, model.look);
  return std::move(model.scene);
}

std::string yaml_of_mesh_scene(const std::string& path, const std::string& file, const LoadOptions& options) {
  const MeshScene model = load_model(path, options);
  std::string node;
  if (has_z_up(path)) {
    node = "    transform: {matrix: [";
    for (const double number : kFromZUp) node += fmt::format("{}{}", node.ends_with('[') ? "" : ", ", number);
    node += "]}  # z is up in the file\n";
  }
  return yaml_of_quick_look(model.look, file, fmt::format(", crease: {}", kCrease), node, model.is_coloured);
}

}  // namespace rayfarm
