#pragma once
// The channels of a pixel: what the renderer fills, the wire carries, the frame buffer holds and files name.
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "common/image/pixel_format.h"

namespace rayfarm {

/// A value of every pixel.
struct PixelChannel {
  std::string_view name;  ///< as OpenEXR calls it
  PixelFormat format = PixelFormat::half_float;
  size_t offset_bytes = 0;  ///< in the pixel
  bool operator==(const PixelChannel&) const = default;
};

/// A pixel's bytes: its channels' values, one after the other.
struct PixelLayout {
  std::vector<PixelChannel> channels;
  size_t bytes = 0;  ///< of a pixel
  bool operator==(const PixelLayout&) const = default;

  /// The number of the channel of this name, if there is one.
  std::optional<size_t> find(std::string_view name) const;
  /// Three bytes of colour and nothing else: what the pixel wire carries, and the block codec compresses.
  bool is_rgb8() const;
};

/// The one list of channels: linear Rec.709 colour in the format that the user asks for.
PixelLayout make_pixel_layout(PixelFormat color);

/// The linear value of a pixel's channel.
double decode_value(const PixelChannel& channel, const std::byte* pixel);

}  // namespace rayfarm
