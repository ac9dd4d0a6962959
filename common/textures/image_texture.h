#pragma once
// Image textures, prepared when a scene is loaded.
#include <string>
#include <vector>

#include "common/textures/texture.h"

namespace rayfarm {

/// Reads an image and halves it again and again (mip map; Williams 1983). Eight-bit formats hold sRGB, EXR,
/// HDR and PFM linear light. Sets the sizes of `texture`; returns three halves a texel. Throws IoError.
std::vector<uint16_t> load_texels(const std::string& path, Texture& texture);

}  // namespace rayfarm
