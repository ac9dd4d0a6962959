#include "common/image/pixel_layout.h"

#include <algorithm>
#include <bit>

#include "common/image/half_float.h"

namespace rayfarm {
namespace {

/// Writes a linear value at `out`, which has bytes_of(format) bytes.
void encode_value(PixelFormat format, double value, std::byte* out) {
  switch (format) {
    case PixelFormat::rgb8:
      *out = static_cast<std::byte>(encode_srgb8(value));
      break;
    case PixelFormat::half_float: {
      const uint16_t bits = half_of_float(value);
      out[0] = static_cast<std::byte>(bits & 0xff);
      out[1] = static_cast<std::byte>(bits >> 8);
      break;
    }
    case PixelFormat::float32: {
      const auto bits = std::bit_cast<uint32_t>(static_cast<float>(value));
      for (size_t i = 0; i < 4; ++i) out[i] = static_cast<std::byte>(bits >> (8 * i) & 0xff);
      break;
    }
  }
}

}  // namespace

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

void encode_pixel(const PixelLayout& layout, std::span<const double> values, std::byte* out) {
  for (size_t i = 0; i < layout.channels.size(); ++i)
    encode_value(layout.channels[i].format, values[i], out + layout.channels[i].offset_bytes);
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
