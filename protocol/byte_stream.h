#pragma once
// Bytes of messages: little-endian, written and read field by field. A reader checks every bound; nothing off
// the wire is ever cast to a struct.
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "protocol/protocol_error.h"

namespace rayfarm {

using Bytes = std::vector<std::byte>;

class ByteWriter {
 public:
  void u8(uint8_t v) { put(v, 1); }
  void u16(uint16_t v) { put(v, 2); }
  void u32(uint32_t v) { put(v, 4); }
  void u64(uint64_t v) { put(v, 8); }
  /// 7 bits a byte, lowest first: small numbers take one byte.
  void varint(uint64_t v) {
    for (; v >= 0x80; v >>= 7) u8(static_cast<uint8_t>(v | 0x80));
    u8(static_cast<uint8_t>(v));
  }
  void bytes(std::span<const std::byte> b) { bytes_.insert(bytes_.end(), b.begin(), b.end()); }
  void text(const std::string& s) {
    varint(s.size());
    bytes(std::as_bytes(std::span(s)));
  }
  Bytes take() { return std::move(bytes_); }
  size_t size() const { return bytes_.size(); }

 private:
  void put(uint64_t v, int count) {
    for (int i = 0; i < count; ++i) bytes_.push_back(static_cast<std::byte>(v >> (8 * i) & 0xff));
  }
  Bytes bytes_;
};

/// Throws ProtocolError on a read beyond the end.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  uint8_t u8() { return static_cast<uint8_t>(get(1)); }
  uint16_t u16() { return static_cast<uint16_t>(get(2)); }
  uint32_t u32() { return static_cast<uint32_t>(get(4)); }
  uint64_t u64() { return get(8); }
  uint64_t varint() {
    uint64_t v = 0;
    for (int shift = 0; shift < 64; shift += 7) {
      const uint8_t b = u8();
      v |= static_cast<uint64_t>(b & 0x7f) << shift;
      if (!(b & 0x80)) return v;
    }
    throw ProtocolError("a number in a message is too long");
  }
  std::span<const std::byte> bytes(size_t count) {
    need(count);
    const auto result = bytes_.subspan(position_, count);
    position_ += count;
    return result;
  }
  std::span<const std::byte> rest() { return bytes(bytes_.size() - position_); }
  std::string text() {
    const uint64_t size = varint();
    if (size > bytes_.size()) throw ProtocolError("a text in a message is longer than the message");
    const auto b = bytes(size);
    return {reinterpret_cast<const char*>(b.data()), b.size()};
  }
  bool at_end() const { return position_ == bytes_.size(); }
  void expect_end() const {
    if (!at_end()) throw ProtocolError("a message is longer than its content");
  }

 private:
  void need(size_t count) const {
    if (count > bytes_.size() - position_) throw ProtocolError("a message ends in the middle of its content");
  }
  uint64_t get(size_t count) {
    need(count);
    uint64_t v = 0;
    for (size_t i = 0; i < count; ++i) v |= static_cast<uint64_t>(bytes_[position_ + i]) << (8 * i);
    position_ += count;
    return v;
  }
  std::span<const std::byte> bytes_;
  size_t position_ = 0;
};

}  // namespace rayfarm
