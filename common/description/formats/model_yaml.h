#pragma once
// A scene that shows a model, as text to go on from.
#include "common/description/scene_description.h"

namespace rayfarm {

/// How a scene takes a model from its file.
struct ModelNode {
  std::string file;       ///< its name, relative to the scene's folder
  std::string mesh_keys;  ///< beside `file`: ", crease: 40"
  uint32_t material = 0;  ///< the node's; 0: the file gives all faces theirs
  bool has_z_up = false;  ///< it is turned, so that y is up
};

/// The YAML of a scene whose root holds the model and perhaps ground and lamp of a quick look, in this order:
/// view, what it asks of `render`, materials and shapes are spelled out, the model is named. It renders to
/// the same bytes.
std::string yaml_of_model(const SceneDescription& scene, const ModelNode& node);

/// Rows of x y z 1: z becomes y, and y points away from the viewer. Without a rounding error.
inline constexpr double kFromZUp[] = {1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0};

}  // namespace rayfarm
