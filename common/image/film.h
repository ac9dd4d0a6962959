#pragma once
// The film: a rectangle of pixels that the renderer exposes, with the channels that its layout lists.
#include "common/image/pixel_layout.h"
#include "common/image/pixel_rect.h"

namespace rayfarm {

class Film {
 public:
  Film(const PixelRect& rect, const PixelLayout& layout);

  /// Sets a pixel of the rectangle: `values` linear, in the order of the layout's channels.
  void expose(int x, int y, std::span<const double> values);

  /// Pixels with a value that is infinite or no number.
  uint64_t not_finite() const { return not_finite_; }
  /// Height × width × layout.bytes, row-major, origin top left. The film is empty after it.
  std::vector<std::byte> take_pixels() { return std::move(pixels_); }

 private:
  PixelRect rect_;
  PixelLayout layout_;
  std::vector<std::byte> pixels_;
  uint64_t not_finite_ = 0;
};

}  // namespace rayfarm
