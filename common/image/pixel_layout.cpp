#include "common/image/pixel_layout.h"

#include <algorithm>

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

void encode_pixel(const PixelLayout& layout, std::span<const double> values, std::byte* out) {
  for (size_t i = 0; i < layout.channels.size(); ++i)
    encode_value(layout.channels[i].format, values[i], out + layout.channels[i].offset_bytes);
}

}  // namespace rayfarm
