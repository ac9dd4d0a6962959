#pragma once
// Lossless compression of bytes of any kind, by zstd.
#include <optional>

#include "protocol/byte_stream.h"

namespace rayfarm {

/// Nothing if they would not get smaller.
std::optional<Bytes> compress_bytes(std::span<const std::byte> bytes);

/// The inverse; throws ProtocolError if the bytes are damaged or would be more than `most`.
Bytes decompress_bytes(std::span<const std::byte> compressed, size_t most);

}  // namespace rayfarm
