#pragma once
// Lossless compression of a block of RGB8 pixels: green is taken from red and blue, each channel is predicted
// from its left and upper neighbours (the median edge detector of LOCO-I; Weinberger, Seroussi, Sapiro 2000),
// and what is left goes through zstd, channel by channel.
#include "protocol/byte_stream.h"

namespace rayfarm {

/// `pixels`: height × width × 3 bytes, row-major.
Bytes compress_rgb8(std::span<const std::byte> pixels, int width, int height);

/// The inverse; throws ProtocolError if the bytes are not a block of that size.
Bytes decompress_rgb8(std::span<const std::byte> compressed, int width, int height);

}  // namespace rayfarm
