#include "common/description/formats/mesh_scene.h"

#include "common/description/formats/mesh_loaders.h"
#include "common/description/formats/model_yaml.h"
#include "common/description/formats/scene_loaders.h"
#include "common/description/quick_look.h"
#include "common/description/scene_bounds.h"
#include "common/image/image_file.h"

namespace rayfarm {
namespace {

/// Edges between faces that meet at a larger angle, in degrees, stay sharp where a file says nothing of it.
constexpr double kCrease = 40;

/// Of programs for machine parts, whose files are STL, z is up.
bool has_z_up(const std::string& path, const LoadOptions& options) {
  return options.up == UpAxis::usual ? extension_of(path) == ".stl" : options.up == UpAxis::z;
}

/// Such a file is a scene with materials, and perhaps a view and lights, of its own.
bool is_gltf(const std::string& path) {
  return extension_of(path) == ".glb" || extension_of(path) == ".gltf";
}

/// The material of the model.
constexpr uint32_t kModelMaterial = 1;

}  // namespace

SceneDescription load_mesh_scene(const std::string& path, const LoadOptions& options) {
  SceneDescription scene;
  scene.materials.emplace_back("default");
  scene.objects = {{"scene", {}, {}, {}}, {"model", {}, {}, {}}};
  ChildDescription model{1, {}, {}};
  if (has_z_up(path, options)) {
    TransformStep& turn = model.transform.emplace_back();
    turn.kind = TransformKind::matrix;
    turn.curve = constant_curve(Vec4(0));
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) turn.matrix.linear[column][row] = kFromZUp[4 * row + column];
  }
  scene.objects[0].children.push_back(std::move(model));
  scene.materials.push_back(quick_look_material(false));
  const MeshRequest request{path, kModelMaterial, Smoothing::flat, {}, false, kCrease};
  find_mesh_format(path)->load(scene, 1, request, options);
  bool is_coloured = false;
  for (const PrimitiveDescription& primitive : scene.objects[1].primitives)
    if (const auto* mesh = std::get_if<MeshShape>(&primitive.shape)) is_coloured |= !mesh->colors.empty();
  scene.materials[kModelMaterial] = quick_look_material(is_coloured);
  const Box bounds = bounds_of(scene);
  if (bounds.is_empty()) throw InputError({path}, "there is nothing in it to look at");
  add_quick_look(scene, make_quick_look(bounds));
  return scene;
}

std::string yaml_of_mesh_scene(const std::string& path, const std::string& file, const LoadOptions& options) {
  ModelNode node;
  node.file = file;
  if (is_gltf(path)) return yaml_of_model(load_gltf_scene(path, options), node);
  node.mesh_keys = fmt::format(", crease: {}", kCrease);
  node.material = kModelMaterial;
  node.has_z_up = has_z_up(path, options);
  return yaml_of_model(load_mesh_scene(path, options), node);
}

SceneDescription load_bare_mesh(const std::string& path, const LoadOptions& options) {
  SceneDescription scene;
  scene.materials.emplace_back("default");
  scene.objects.push_back({"scene", {}, {}, {}});
  find_mesh_format(path)->load(scene, 0, {path, 0, Smoothing::flat, {}, false}, options);
  validate(scene, options.stop);
  return scene;
}

}  // namespace rayfarm
