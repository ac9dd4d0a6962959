#pragma once
// Pictures of frames that are not whole: what there is of them, for who stopped the job and wants to see.
#include <string>

#include "common/image/image.h"
#include "host/farm/frame_buffer.h"

namespace rayfarm {

/// Of a frame's file: NAME.partial.png beside it.
std::string preview_of(const std::string& file);

/// True if such a picture stands there, and nobody else's: it may be replaced or removed.
bool is_preview(const std::string& path);

/// 8 bits a channel; a chequer of greys stands for subpolygons that are not there. Throws IoError, and
/// std::runtime_error if the pixels hold no colour, or something else stands there.
/// \param image size, window and layout of the pixels
/// \param buffer with all its bands
void write_preview(const std::string& path, const Image& image, const FrameBuffer& buffer);

}  // namespace rayfarm
