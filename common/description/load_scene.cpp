#include <algorithm>
#include <set>

#include "common/description/formats/mesh_loaders.h"
#include "common/description/formats/scene_loaders.h"
#include "common/image/image_file.h"

namespace rayfarm {
namespace {

/// Every format that a scene may be in.
struct Format {
  const char* extension;
  SceneDescription (*load)(const std::string& path, const LoadOptions& options);
};
constexpr Format kFormats[] = {{".yaml", load_yaml_scene}, {".yml", load_yaml_scene},
                               {".nff", load_nff_scene},   {".glb", load_gltf_scene},
                               {".gltf", load_gltf_scene}, {".rfp", load_part_scene}};

/// What to do with a file that is no scene.
std::string advice_for(const std::string& extension) {
  static const std::set<std::string> kOtherModels{".3ds",  ".3mf", ".abc",  ".blend", ".dae", ".fbx",
                                                  ".step", ".usd", ".usda", ".usdc",  ".usdz"};
  return kOtherModels.contains(extension) ? "; export it as .glb" : "";
}

/// Says what was asked for and changes nothing.
void add_notes_of_idle_options(SceneDescription& scene, const std::string& extension,
                               const LoadOptions& options) {
  const auto is_gltf = [](const std::string& e) { return e == ".glb" || e == ".gltf"; };
  const bool has_clips = std::any_of(scene.files.begin(), scene.files.end(),
                                     [&](const std::string& file) { return is_gltf(extension_of(file)); });
  if (!has_clips && (!options.clip.empty() || options.fps != LoadOptions().fps))
    scene.notes.add(scene.source(),
                    "`--clip` and `--fps` are of clips in glTF files, and change nothing here");
  const bool is_mesh_alone = find_mesh_format(scene.files.at(0)) && !is_gltf(extension);
  if (!is_mesh_alone && options.up != UpAxis::usual)
    scene.notes.add(scene.source(),
                    "`--up` is of meshes that are scenes by themselves, and changes nothing here");
  if (!is_gltf(extension) && !options.camera.empty())
    scene.notes.add(scene.source(), "`--camera` is of cameras in glTF files, and changes nothing here");
}

}  // namespace

SceneDescription load_scene(const std::string& path, const LoadOptions& options) try {
  const std::string extension = extension_of(path);
  const auto format = std::find_if(std::begin(kFormats), std::end(kFormats),
                                   [&](const Format& f) { return extension == f.extension; });
  if (format == std::end(kFormats) && !find_mesh_format(path))
    throw IoError(
        fmt::format("{}: unknown scene format '{}'; Rayfarm reads .yaml and .nff, meshes ({}), and objects "
                    "that it compiled (.rfp){}",
                    path, extension, mesh_extensions(), advice_for(extension)));
  SceneDescription scene =
      format != std::end(kFormats) ? format->load(path, options) : load_mesh_scene(path, options);
  add_notes_of_idle_options(scene, extension, options);
  validate(scene, options.stop);
  return scene;
} catch (const std::bad_alloc&) {
  throw IoError(fmt::format("{}: the scene and its files need more memory than there is", path));
}

}  // namespace rayfarm
