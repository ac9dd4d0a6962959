#pragma once
// glTF 2.0 in one file (.glb: Khronos Group 2021, chapter 4): meshes whose vertices have colours, shown as
// they are (KHR_materials_unlit), and a camera.
#include <optional>
#include <string>
#include <vector>

#include "common/math/vector.h"
#include "host/files/json.h"

namespace rayfarm {

/// Seen from where its triangles are counter-clockwise.
struct GlbSurface {
  std::vector<glm::vec3> positions;
  std::vector<glm::vec4> colors;  ///< linear, in [0, 1]
  std::vector<uint32_t> indices;  ///< three each
};

struct GlbMesh {
  std::string name;
  uint32_t material = 0;
  std::vector<GlbSurface> surfaces;
};

struct GlbCamera {
  Vec3 location{0}, right{1, 0, 0}, up{0, 1, 0};
  double field_of_view = 1;  ///< from top to bottom, in radians
  double aspect = 1;         ///< width over height
  double near = 0.01;        ///< what is nearer is not seen
};

struct GlbScene {
  std::vector<std::string> materials;  ///< names
  std::vector<GlbMesh> meshes;
  std::optional<GlbCamera> camera;
  Json::Object about;  ///< what made it
};

/// The file appears when it is whole. Throws IoError.
void write_glb(const std::string& path, const GlbScene& scene);

}  // namespace rayfarm
