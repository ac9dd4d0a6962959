#pragma once
// Cameras of a glTF file as the view.
#include "common/description/formats/gltf/nodes.h"

namespace rayfarm {

/// Lists the file's cameras in the scene, none of them its view.
void list_cameras(const GltfFile& file, const std::vector<GltfPlacedCamera>& cameras,
                  SceneDescription& scene);

/// Lists them, and sets the view to the camera that the options name, or the first. Throws InputError if
/// there is none of that name.
void set_view(const GltfFile& file, const GltfAnimation& animation,
              const std::vector<GltfPlacedCamera>& cameras, SceneDescription& scene);

}  // namespace rayfarm
