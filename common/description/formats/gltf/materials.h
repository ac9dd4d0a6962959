#pragma once
// Materials and textures of a glTF file: they join the scene when something uses them.
#include <map>
#include <set>
#include <tuple>

#include "common/description/formats/gltf/file.h"
#include "common/description/scene_description.h"
#include "common/textures/image_texture.h"

namespace rayfarm {

class GltfMaterials {
 public:
  /// Both must outlive it.
  GltfMaterials(const GltfFile& file, SceneDescription& scene) : file_(file), scene_(scene) {}

  /// The scene's material for one of the file's; kNone: glTF's own for what has none. `has_opacity`: of the
  /// vertices, which it weighs if it is blended or masked. Throws InputError.
  uint32_t material(uint32_t index, bool has_opacity);
  /// How many of the file's are in use.
  size_t count() const { return made_.size(); }

 private:
  enum class Colors { srgb, numbers };  ///< what an image's values are
  uint32_t texture(uint32_t index, ImagePart part, Colors colors);
  uint32_t image(uint32_t source, uint32_t sampler, ImagePart part, Colors colors);
  void note_once(const char* what);

  /// One material on its way.
  struct Reader;

  const GltfFile& file_;
  SceneDescription& scene_;
  std::map<std::pair<uint32_t, bool>, uint32_t> made_;
  std::map<std::tuple<uint32_t, uint32_t, ImagePart, Colors>, uint32_t> images_;
  std::set<std::string> noted_;
};

}  // namespace rayfarm
