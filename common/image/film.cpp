#include "common/image/film.h"

namespace rayfarm {

Film::Film(const PixelRect& rect, const PixelLayout& layout)
    : rect_(rect), bytes_(layout.bytes), pixels_(static_cast<size_t>(rect.area()) * layout.bytes) {
  for (size_t i = 0; i < layout.channels.size(); ++i) {
    const PixelChannel& channel = layout.channels[i];
    if (i > 0 && channel.format == runs_.back().format)
      ++runs_.back().count;
    else
      runs_.push_back({channel.format, i, 1, channel.offset_bytes});
  }
}

}  // namespace rayfarm
