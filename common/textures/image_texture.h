#pragma once
// Image textures, prepared when a scene is loaded.
#include <string>
#include <vector>

#include "common/errors/stop.h"
#include "common/textures/texture.h"

namespace rayfarm {

/// Reads an image and halves it again and again (mip map; Williams 1983). Eight-bit formats hold sRGB, EXR,
/// HDR and PFM linear light. Sets the sizes of `texture`; returns three halves a texel. Throws IoError, also
/// if the image has more than `most_pixels`, and Stopped.
std::vector<uint16_t> load_texels(const std::string& path, Texture& texture, uint64_t most_pixels,
                                  const std::stop_token& stop = {});

}  // namespace rayfarm
