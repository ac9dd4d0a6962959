#pragma once
// The film: a rectangle of pixels that the renderer exposes, with the channels that its layout lists.
#include <cmath>

#include "common/image/pixel_layout.h"
#include "common/image/pixel_rect.h"

namespace rayfarm {

class Film {
 public:
  Film(const PixelRect& rect, const PixelLayout& layout);

  /// Sets a pixel of the rectangle: `values` linear, in the order of the layout's channels.
  void expose(int x, int y, std::span<const double> values) {
    const auto pixel = static_cast<size_t>(y - rect_.y0) * static_cast<size_t>(rect_.width()) +
                       static_cast<size_t>(x - rect_.x0);
    for (const double value : values)
      if (!std::isfinite(value)) {
        ++not_finite_;
        break;
      }
    std::byte* const out = pixels_.data() + pixel * bytes_;
    for (const Run& run : runs_)
      encode_values(run.format, values.subspan(run.first, run.count), out + run.offset_bytes);
  }

  /// Pixels with a value that is infinite or no number.
  uint64_t not_finite() const { return not_finite_; }
  /// Height × width × layout.bytes, row-major, origin top left. The film is empty after it.
  std::vector<std::byte> take_pixels() { return std::move(pixels_); }

 private:
  /// Channels that follow each other and have one format.
  struct Run {
    PixelFormat format;
    size_t first, count, offset_bytes;
  };
  PixelRect rect_;
  size_t bytes_;  ///< of a pixel
  std::vector<Run> runs_;
  std::vector<std::byte> pixels_;
  uint64_t not_finite_ = 0;
};

}  // namespace rayfarm
