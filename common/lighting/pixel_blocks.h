#pragma once
// Pixels of a rectangle, one by one and in blocks.
#include <algorithm>
#include <span>
#include <vector>

#include "common/image/pixel_rect.h"
#include "common/math/ray_packet.h"

namespace rayfarm {

/// Pixels whose rays are traced together.
inline constexpr int kBlockWidth_px = 4, kBlockHeight_px = 2;
static_assert(kBlockWidth_px * kBlockHeight_px == kMostPacketRays);

struct Pixel {
  int x = 0, y = 0;
};

/// Blocks stand where they do in every picture, however it is cut. Calls visit(block's corner, its pixels
/// inside `rect`).
template <typename Visitor>
void for_each_block(const PixelRect& rect, Visitor visit) {
  for (int y = rect.y0 / kBlockHeight_px * kBlockHeight_px; y < rect.y1; y += kBlockHeight_px)
    for (int x = rect.x0 / kBlockWidth_px * kBlockWidth_px; x < rect.x1; x += kBlockWidth_px)
      visit(Pixel{x, y},
            PixelRect{std::max(x, rect.x0), std::max(y, rect.y0), std::min(x + kBlockWidth_px, rect.x1),
                      std::min(y + kBlockHeight_px, rect.y1)});
}

inline bool contains(const PixelRect& rect, const Pixel& p) {
  return p.x >= rect.x0 && p.x < rect.x1 && p.y >= rect.y0 && p.y < rect.y1;
}

/// A value for each pixel of a rectangle.
template <typename T>
class PixelMap {
 public:
  PixelMap(const PixelRect& rect, const T& value)
      : rect_(rect), values_(static_cast<size_t>(rect.area()), value) {}
  const PixelRect& rect() const { return rect_; }
  std::span<T> values() { return values_; }
  T& operator[](const Pixel& p) {
    return values_[static_cast<size_t>(p.y - rect_.y0) * static_cast<size_t>(rect_.width()) +
                   static_cast<size_t>(p.x - rect_.x0)];
  }

 private:
  PixelRect rect_;
  std::vector<T> values_;
};

}  // namespace rayfarm
