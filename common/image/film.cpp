#include "common/image/film.h"

#include <algorithm>
#include <cmath>

namespace rayfarm {

Film::Film(const PixelRect& rect, const PixelLayout& layout)
    : rect_(rect), layout_(layout), pixels_(static_cast<size_t>(rect.area()) * layout.bytes) {}

void Film::expose(int x, int y, std::span<const double> values) {
  const auto pixel = static_cast<size_t>(y - rect_.y0) * static_cast<size_t>(rect_.width()) +
                     static_cast<size_t>(x - rect_.x0);
  if (!std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); }))
    ++not_finite_;
  encode_pixel(layout_, values, pixels_.data() + pixel * layout_.bytes);
}

}  // namespace rayfarm
