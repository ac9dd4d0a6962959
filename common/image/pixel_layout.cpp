#include "common/image/pixel_layout.h"

#include <algorithm>
#include <bit>

#include "common/image/half_float.h"

namespace rayfarm {
std::optional<size_t> PixelLayout::find(std::string_view name) const {
  const auto found = std::find_if(channels.begin(), channels.end(),
                                  [&](const PixelChannel& channel) { return channel.name == name; });
  if (found == channels.end()) return std::nullopt;
  return static_cast<size_t>(found - channels.begin());
}

bool PixelLayout::is_rgb8() const {
  return *this == make_pixel_layout(PixelFormat::rgb8);
}

PixelLayout make_pixel_layout(PixelFormat color) {
  PixelLayout layout{{{"R", color}, {"G", color}, {"B", color}}};
  for (PixelChannel& channel : layout.channels) {
    channel.offset_bytes = layout.bytes;
    layout.bytes += bytes_of(channel.format);
  }
  return layout;
}

double decode_value(const PixelChannel& channel, const std::byte* pixel) {
  const std::byte* const in = pixel + channel.offset_bytes;
  switch (channel.format) {
    case PixelFormat::rgb8:
      return decode_srgb8(static_cast<uint8_t>(*in));
    case PixelFormat::half_float:
      return float_of_half(
          static_cast<uint16_t>(static_cast<unsigned>(in[0]) | static_cast<unsigned>(in[1]) << 8));
    case PixelFormat::float32: {
      uint32_t bits = 0;
      for (size_t i = 0; i < 4; ++i) bits |= static_cast<uint32_t>(in[i]) << (8 * i);
      return static_cast<double>(std::bit_cast<float>(bits));
    }
  }
  return 0;
}

}  // namespace rayfarm
