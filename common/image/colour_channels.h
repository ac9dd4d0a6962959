#pragma once
#include <array>

#include "common/image/pixel_layout.h"

namespace rayfarm {

/// The layout's R, G and B. Throws std::runtime_error if it lacks one.
std::array<PixelChannel, 3> colour_channels(const PixelLayout& layout);

}  // namespace rayfarm
