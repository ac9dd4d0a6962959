#include "common/image/image.h"

namespace rayfarm {

double channel_value(const Image& image, size_t pixel, size_t channel) {
  return decode_value(image.layout.channels[channel], image.pixels.data() + pixel * image.layout.bytes);
}

}  // namespace rayfarm
