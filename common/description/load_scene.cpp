#include <cerrno>
#include <cstring>
#include <filesystem>
#include <set>

#include "common/description/formats/scene_loaders.h"
#include "common/files/regular_file.h"
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
std::string advice_for(const std::string& path, const std::string& extension) {
  static const std::set<std::string> kOtherMeshes{".3ds", ".abc", ".blend", ".dae",  ".fbx",  ".off",
                                                  ".ply", ".stl", ".usd",   ".usda", ".usdc", ".usdz"};
  const bool is_other = kOtherMeshes.contains(extension);
  if (extension != ".obj" && !is_other) return "";
  std::filesystem::path mesh = std::filesystem::path(path).filename();
  if (is_other) mesh.replace_extension(".obj");
  return fmt::format("; {} .obj mesh{} goes into a .yaml scene: `- mesh: {{file: {}}}`",
                     is_other ? "export it as an" : "an", is_other ? ", which" : "", mesh.string());
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
  if (!is_gltf(extension) && !options.camera.empty())
    scene.notes.add(scene.source(), "`--camera` is of cameras in glTF files, and changes nothing here");
}

}  // namespace

SceneDescription load_scene(const std::string& path, const LoadOptions& options) try {
  const std::string extension = extension_of(path);
  for (const Format& format : kFormats) {
    if (extension != format.extension) continue;
    SceneDescription scene = format.load(path, options);
    add_notes_of_idle_options(scene, extension, options);
    validate(scene, options.stop);
    return scene;
  }
  throw IoError(
      fmt::format("{}: unknown scene format '{}'; Rayfarm reads .yaml, .nff, .glb and .gltf, and objects "
                  "that it compiled (.rfp){}",
                  path, extension, advice_for(path, extension)));
} catch (const std::bad_alloc&) {
  throw IoError(fmt::format("{}: the scene and its files need more memory than there is", path));
}

}  // namespace rayfarm
