#pragma once
// A material as an MTL file says it, and what it becomes in a scene. The table is in scenes/README.md.
#include <optional>
#include <string>

#include "common/description/scene_description.h"

namespace rayfarm {

/// A file of a map, with its options.
struct MtlMap {
  std::string file;  ///< as it is written, with slashes
  Vec2 offset{0}, scale{1};
  bool is_clamped = false;
  char channel = 0;     ///< of -imfchan: r g b m l z; 0: not said
  double bump = 1;      ///< of -bm
  SourcePlace place{};  ///< of the file's name
};

/// Numbers are float, as those of the mesh. What is not said is empty.
struct MtlMaterial {
  std::string name;
  SourcePlace place;
  std::optional<glm::vec3> diffuse, specular, emission, filter;    ///< Kd, Ks, Ke, Tf
  std::optional<float> shininess, index, opacity, transparency;    ///< Ns, Ni, d, Tr
  std::optional<float> roughness, metallic, coat, coat_roughness;  ///< Pr, Pm, Pc, Pcr
  std::optional<int> illumination;
  std::optional<MtlMap> diffuse_map, specular_map, emission_map, opacity_map, bump_map, normal_map,
      roughness_map, metallic_map, coat_map, coat_roughness_map;
};

/// Appends the material, and the images that it names, to the scene; `library` is the file that it is from.
/// Throws InputError where an image can't be read, and Stopped.
void add_mtl_material(SceneDescription& scene, const std::string& library, const MtlMaterial& material,
                      const std::stop_token& stop);

}  // namespace rayfarm
