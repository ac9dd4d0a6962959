#pragma once
// Numbers in groups of 3 bits, each with a bit that says whether another follows, lowest first, two groups a
// byte: a result carries many numbers, and most of them are small.
#include "protocol/byte_stream.h"

namespace rayfarm {

class GroupWriter {
 public:
  explicit GroupWriter(ByteWriter& bytes) : bytes_(bytes) {}
  void number(uint64_t v) {
    for (; v >= 8; v >>= 3) group(static_cast<uint8_t>(v & 7) | 8u);
    group(static_cast<uint8_t>(v));
  }
  /// To be called behind the last.
  void finish() {
    if (has_half_) bytes_.u8(half_);
    has_half_ = false;
  }

 private:
  void group(unsigned g) {
    if (has_half_)
      bytes_.u8(static_cast<uint8_t>(half_ | g << 4));
    else
      half_ = static_cast<uint8_t>(g);
    has_half_ = !has_half_;
  }
  ByteWriter& bytes_;
  uint8_t half_ = 0;
  bool has_half_ = false;
};

class GroupReader {
 public:
  explicit GroupReader(ByteReader& bytes) : bytes_(bytes) {}
  uint64_t number() {
    uint64_t v = 0;
    for (int shift = 0; shift < 64; shift += 3) {
      const unsigned g = group();
      v |= uint64_t{g & 7} << shift;
      if (!(g & 8)) return v;
    }
    throw ProtocolError("a number in a message is too long");
  }

 private:
  unsigned group() {
    has_half_ = !has_half_;
    if (has_half_) byte_ = bytes_.u8();
    return has_half_ ? byte_ & 15u : byte_ >> 4;
  }
  ByteReader& bytes_;
  unsigned byte_ = 0;
  bool has_half_ = false;
};

}  // namespace rayfarm
