#include "common/image/image.h"

#include <cstring>

#include "common/image/half_float.h"

namespace rayfarm {

double channel_value(const Image& image, size_t pixel, size_t channel) {
  const std::byte* p = image.pixels.data() + pixel * bytes_per_pixel(image.format);
  switch (image.format) {
    case PixelFormat::rgb8:
      return decode_srgb8(static_cast<uint8_t>(p[channel]));
    case PixelFormat::half_float: {
      const auto bits = static_cast<uint16_t>(static_cast<unsigned>(p[2 * channel]) |
                                              static_cast<unsigned>(p[2 * channel + 1]) << 8);
      return float_of_half(bits);
    }
    case PixelFormat::float32: {
      uint32_t bits = 0;
      for (size_t i = 0; i < 4; ++i) bits |= static_cast<uint32_t>(p[4 * channel + i]) << (8 * i);
      float f = 0;
      std::memcpy(&f, &bits, sizeof f);
      return static_cast<double>(f);
    }
  }
  return 0;
}

}  // namespace rayfarm
