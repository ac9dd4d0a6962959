#pragma once
// A picture in memory, as it is written.
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/image/pixel_layout.h"
#include "common/image/pixel_rect.h"

namespace rayfarm {

/// A picture to write: the rendered rectangle of an image.
struct Image {
  int width_px = 0, height_px = 0;  ///< of the whole image (EXR: the display window)
  PixelRect window;                 ///< what `pixels` hold (EXR: the data window)
  PixelLayout layout;
  std::vector<std::byte> pixels;  ///< window height × width × layout.bytes, row-major, origin top left
};

/// What a picture's file says of it.
struct ImageInfo {
  int width_px = 0, height_px = 0;  ///< of the whole image; a PNG doesn't say it, so that it is the window's
  PixelRect window;                 ///< whose pixels the file holds
  /// Of its colour; none if it is not as Rayfarm writes it.
  std::optional<PixelFormat> format;
  std::map<std::string, std::string> attributes;
};

/// The linear value of a pixel's channel.
double channel_value(const Image& image, size_t pixel, size_t channel);

}  // namespace rayfarm
