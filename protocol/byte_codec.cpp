#include "protocol/byte_codec.h"

#include <zstd.h>

namespace rayfarm {
namespace {
/// Of zstd: numbers that are mostly small, of which higher levels make little less.
constexpr int kBytesLevel = 1;
}  // namespace

std::optional<Bytes> compress_bytes(std::span<const std::byte> bytes) {
  Bytes out(ZSTD_compressBound(bytes.size()));
  const size_t size = ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), kBytesLevel);
  if (ZSTD_isError(size) || size >= bytes.size()) return std::nullopt;
  out.resize(size);
  return out;
}

Bytes decompress_bytes(std::span<const std::byte> compressed, size_t most) {
  const unsigned long long size = ZSTD_getFrameContentSize(compressed.data(), compressed.size());
  if (size == ZSTD_CONTENTSIZE_UNKNOWN || size == ZSTD_CONTENTSIZE_ERROR)
    throw ProtocolError("compressed bytes are damaged");
  if (size > most) throw ProtocolError("compressed bytes are more than there may be");
  Bytes bytes(size);
  const size_t got = ZSTD_decompress(bytes.data(), bytes.size(), compressed.data(), compressed.size());
  if (ZSTD_isError(got) || got != bytes.size()) throw ProtocolError("compressed bytes are damaged");
  return bytes;
}

}  // namespace rayfarm
