// glTF 2.0: Khronos Group, "glTF 2.0 Specification" (2021), and its ratified extensions. Its JSON is read by
// nlohmann's library. A loader of all of it, as tinygltf, is not used: it trusts what it reads, and a damaged
// file must end in an error.
#include <fmt/format.h>

#include "common/description/formats/gltf/cameras.h"
#include "common/description/formats/mesh_loaders.h"
#include "common/description/formats/scene_loaders.h"
#include "common/description/quick_look.h"
#include "common/description/scene_bounds.h"

namespace rayfarm {
namespace {

constexpr const char* kExtensions[] = {
    "KHR_lights_punctual",   "KHR_materials_clearcoat", "KHR_materials_emissive_strength",
    "KHR_materials_ior",     "KHR_materials_specular",  "KHR_materials_transmission",
    "KHR_materials_unlit",   "KHR_materials_volume",    "KHR_mesh_quantization",
    "KHR_texture_transform", "EXT_mesh_gpu_instancing", "EXT_meshopt_compression",
    "EXT_texture_webp"};

bool is_known(const std::string& extension) {
  return std::find(std::begin(kExtensions), std::end(kExtensions), extension) != std::end(kExtensions);
}

/// Refuses what can't be read without an extension, and notes what is shown without it.
void check_extensions(const GltfFile& file, Notes& notes) {
  const auto names_of = [&](const char* list) {
    std::vector<std::string> unknown;
    for (size_t i = 0; i < file.count(list); ++i)
      if (const std::string name = file.item(list, i).text(); !is_known(name))
        unknown.push_back(name.substr(0, 80));
    return unknown;
  };
  if (const auto required = names_of("extensionsRequired"); !required.empty())
    throw InputError({file.path()},
                     fmt::format("it requires the extension {}, which is not read here; export it without",
                                 fmt::join(required, ", ")));
  if (const auto used = names_of("extensionsUsed"); !used.empty())
    notes.add({file.path()}, fmt::format("not used: the extension{} {}", used.size() == 1 ? "" : "s",
                                         fmt::join(used, ", ")));
}

/// Gives the meshes of objects from `first` on the smoothing that was asked for in place of the file's.
void set_smoothing(SceneDescription& scene, size_t first, const MeshRequest& request) {
  size_t without_normals = 0;
  for (size_t i = first; i < scene.objects.size(); ++i)
    for (PrimitiveDescription& primitive : scene.objects[i].primitives) {
      auto& mesh = std::get<MeshShape>(primitive.shape);
      mesh.smoothing = mesh.normals.empty() ? Smoothing::flat : request.smoothing;
      without_normals += mesh.normals.empty() ? 1 : 0;
      if (mesh.smoothing != Smoothing::flat) continue;
      mesh.normals.clear();
      mesh.triangle_normals.clear();
    }
  if (without_normals > 0 && request.smoothing != Smoothing::flat)
    scene.notes.add(
        scene.source(request.place),
        fmt::format("`smooth` does nothing for {} primitive{} without normals: in glTF these are flat",
                    without_normals, without_normals == 1 ? "" : "s"));
}

}  // namespace

SceneDescription load_gltf_scene(const std::string& path, const LoadOptions& options) {
  SceneDescription scene;
  scene.files = {path};
  scene.objects.push_back({"scene", {}, {}, {}});
  scene.materials.emplace_back("default");
  const GltfFile file(path, options);
  check_extensions(file, scene.notes);
  const GltfAnimation animation(file, scene);
  scene.clip.check();
  GltfNodes nodes(file, scene, animation, {});
  const uint32_t root = nodes.add_all();
  nodes.add_notes();
  scene.objects[0].children.push_back({root, {}, {}});
  scene.frames = animation.frames();
  set_view(file, animation, nodes.cameras(), scene);
  const Box bounds = bounds_of(scene);
  if (bounds.is_empty())
    throw InputError({path}, "there is nothing in it to look at: the nodes of its scene have no triangles");
  add_quick_look(scene, make_quick_look(bounds));
  if (scene.render.empty())  // it has lights of its own
    scene.render = {{"lighting", QuickLook::kLighting, {}},
                    {"samples", fmt::format("{}", QuickLook::kSamples), {}}};
  return scene;
}

void load_gltf_mesh(SceneDescription& scene, uint32_t object, const MeshRequest& request,
                    const LoadOptions& options) {
  const GltfFile file(request.path, options);
  scene.files.push_back(request.path);
  check_extensions(file, scene.notes);
  const GltfAnimation animation(file, scene);
  const size_t first_object = scene.objects.size();
  GltfNodes nodes(file, scene, animation, request.place);
  const uint32_t root = nodes.add_all();
  if (request.is_smoothing_asked_for) set_smoothing(scene, first_object, request);
  if (request.crease > 0)
    scene.notes.add(scene.source(request.place),
                    "`crease` does nothing for glTF, whose meshes have normals or are flat");
  nodes.add_notes();
  scene.objects[object].children.push_back({root, {}, request.place});
  if (const auto frames = animation.frames(); frames && !scene.has_own_frames) {
    if (!scene.frames) scene.frames = frames;
    (*scene.frames)[1] = std::max((*scene.frames)[1], (*frames)[1]);  // all clips begin at 0
  }
  list_cameras(file, nodes.cameras(), scene);
  if (!nodes.cameras().empty())
    scene.notes.add({request.path},
                    "its cameras are not used: the scene that names it has a view of its own");
}

}  // namespace rayfarm
