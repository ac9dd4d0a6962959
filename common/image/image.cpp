#include "common/image/image.h"

namespace rayfarm {

double channel_value(const Image& image, size_t pixel, size_t channel) {
  const PixelChannel& c = image.layout.channels[channel];
  return decode_value(c.format, image.pixels.data() + pixel * image.layout.bytes + c.offset_bytes);
}

}  // namespace rayfarm
