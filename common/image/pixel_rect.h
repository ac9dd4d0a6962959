#pragma once
#include <cstdint>

namespace rayfarm {

/// A half-open rectangle of pixels, origin top left.
struct PixelRect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  int64_t area() const { return int64_t{width()} * height(); }
  bool operator==(const PixelRect&) const = default;
  template <typename Archive>
  void serialize(Archive& archive) {
    archive(x0, y0, x1, y1);
  }
};

}  // namespace rayfarm
