#include "common/lighting/zones/power.h"

namespace rayfarm {

void PackedWriter::sums(const PowerSums& sums) {
  uint64_t count = 0, next = 0;
  sums.for_each([&](uint64_t, const Power&) { ++count; });
  number(count);
  sums.for_each([&](uint64_t slot, const Power& p) {
    number(slot - next);
    power(p);
    next = slot + 1;
  });
}

uint64_t PackedReader::number() {
  uint64_t x = 0;
  for (int shift = 0; shift < 64; shift += 7) {
    if (bytes_.empty()) throw damaged();
    const auto byte = static_cast<uint64_t>(bytes_.front());
    bytes_ = bytes_.subspan(1);
    x |= (byte & 0x7f) << shift;
    if (byte < 0x80) return x;
  }
  throw damaged();
}

double PackedReader::real() {
  if (bytes_.size() < 8) throw damaged();
  uint64_t bits = 0;
  for (size_t i = 0; i < 8; ++i) bits |= static_cast<uint64_t>(bytes_[i]) << 8 * i;
  bytes_ = bytes_.subspan(8);
  return std::bit_cast<double>(bits);
}

Color PackedReader::color() {
  Color c;
  for (int i = 0; i < 3; ++i) {
    c[i] = real();
    if (!(c[i] >= 0) || !std::isfinite(c[i])) throw damaged();
  }
  return c;
}

}  // namespace rayfarm
