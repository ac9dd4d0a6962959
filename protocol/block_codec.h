#pragma once
// Lossless compression of a block of RGB8 pixels: the model of block_model.h, the coder of block_tables.h.
// Whole numbers alone, so that bytes are the same on every machine; any thread.
//
// A block begins with a byte that names its set of tables and its slopes; a block of one colour is another
// value of that byte, and the colour. Else what follows are bits, lowest first: zeros and a one, which fill
// the first byte; the coder's state; the first pixel's green; its red and blue; then green, red, blue of each
// pixel, row by row. The coder must end in the state 0 and with the last bit.
#include "protocol/byte_stream.h"

namespace rayfarm {

/// `pixels`: height × width × 3 bytes, row-major. Noise may take more bytes than it is.
Bytes compress_rgb8(std::span<const std::byte> pixels, int width, int height);

/// The inverse, into `pixels` of height × width × 3 bytes; throws ProtocolError if the bytes are not a block
/// of that size, and then `pixels` hold anything.
void decompress_rgb8(std::span<const std::byte> compressed, int width, int height,
                     std::span<std::byte> pixels);
Bytes decompress_rgb8(std::span<const std::byte> compressed, int width, int height);

}  // namespace rayfarm
