#pragma once
// Image textures, prepared when a scene is loaded.
#include <string>
#include <vector>

#include "common/errors/stop.h"
#include "common/image/image_file.h"
#include "common/textures/texture.h"

namespace rayfarm {

/// What of an image file is the texture, and how its numbers are meant.
struct ImageReading {
  enum class Encoding { usual, srgb, linear };
  ImagePart part = ImagePart::color;
  Encoding encoding = Encoding::usual;
};
/// True if its numbers are light, or no light at all: they are taken as they stand.
bool is_linear(const std::string& path, const ImageReading& reading);

/// Reads an image and halves it again and again (mip map; Williams 1983; `Halving`). Eight-bit formats hold
/// sRGB, EXR, HDR and PFM linear light, unless `reading` says otherwise; alpha is no light. Sets the sizes of
/// `texture`; returns three halves a texel. Throws IoError, also if the image has more than `most_pixels`,
/// and Stopped.
std::vector<uint16_t> load_texels(const ImageFile& file, Texture& texture, uint64_t most_pixels,
                                  const std::stop_token& stop = {}, const ImageReading& reading = {});

}  // namespace rayfarm
