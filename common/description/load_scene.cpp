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
constexpr Format kFormats[] = {{".yaml", load_yaml_scene},
                               {".yml", load_yaml_scene},
                               {".nff", load_nff_scene},
                               {".rfp", load_part_scene}};

/// What to do with a file that is no scene.
std::string advice_for(const std::string& extension) {
  static const std::set<std::string> kOtherModels{".3ds",  ".3mf", ".abc",  ".blend", ".dae", ".fbx",
                                                  ".step", ".usd", ".usda", ".usdc",  ".usdz"};
  return kOtherModels.contains(extension) ? "; export it as .obj or .ply" : "";
}

}  // namespace

SceneDescription load_scene(const std::string& path, const LoadOptions& options) try {
  const std::string extension = extension_of(path);
  for (const Format& format : kFormats) {
    if (extension != format.extension) continue;
    SceneDescription scene = format.load(path, options);
    validate(scene, options.stop);
    return scene;
  }
  if (find_mesh_format(path)) {
    SceneDescription scene = load_mesh_scene(path, options);
    validate(scene, options.stop);
    return scene;
  }
  throw IoError(
      fmt::format("{}: unknown scene format '{}'; Rayfarm reads .yaml and .nff, meshes ({}), and objects "
                  "that it compiled "
                  "(.rfp){}",
                  path, extension, mesh_extensions(), advice_for(extension)));
} catch (const std::bad_alloc&) {
  throw IoError(fmt::format("{}: the scene and its files need more memory than there is", path));
}

}  // namespace rayfarm
