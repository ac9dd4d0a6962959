#pragma once
#include "common/description/scene_description.h"
#include "common/scene/scene.h"

namespace rayfarm {

/// Adds a texture with its texels; returns its index.
uint32_t add_texture(SceneArrays<GrowingArray>& arrays, const TextureDescription& texture);

}  // namespace rayfarm
