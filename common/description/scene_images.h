#pragma once
// Images that a scene names.
#include "common/description/scene_description.h"
#include "common/textures/image_texture.h"

namespace rayfarm {

/// How many texels the scene has room for, all in all.
uint64_t texels_left(const SceneDescription& scene);

/// Reads an image into `texture` and adds it to the scene's files, if it is one. Throws IoError, also if the
/// scene's images would have more pixels than `limits` allow, and Stopped.
void load_scene_image(SceneDescription& scene, const ImageFile& file, TextureDescription& texture,
                      const std::stop_token& stop, const ImageReading& reading = {});

}  // namespace rayfarm
