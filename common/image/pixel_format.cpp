#include "common/image/pixel_format.h"

#include <algorithm>
#include <array>

#include "common/math/portable_math.h"

namespace rayfarm {

double decode_srgb(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : portable_pow((encoded + 0.055) / 1.055, 2.4);
}

namespace {

/// thresholds[i]: the smallest linear value that rounds to byte i + 1.
const std::array<double, 255>& thresholds() {
  static const std::array<double, 255> table = [] {
    std::array<double, 255> t{};
    for (size_t i = 0; i < t.size(); ++i) t[i] = decode_srgb((static_cast<double>(i) + 0.5) / 255);
    return t;
  }();
  return table;
}

}  // namespace

uint8_t encode_srgb8(double linear) {
  if (!(linear > 0)) return 0;
  // The first guess is the byte at the lower end of one of these equal steps; at most a few bytes lie in a
  // step.
  constexpr size_t kSteps = 4096;
  static const std::array<uint8_t, kSteps> guesses = [] {
    const auto& t = thresholds();
    std::array<uint8_t, kSteps> table{};
    for (size_t i = 0; i < kSteps; ++i)
      table[i] = static_cast<uint8_t>(std::upper_bound(t.begin(), t.end(), static_cast<double>(i) / kSteps) -
                                      t.begin());
    return table;
  }();
  static const auto& t = thresholds();
  if (linear >= 1) return 255;
  size_t byte = guesses[static_cast<size_t>(linear * kSteps)];
  while (byte < t.size() && t[byte] <= linear) ++byte;
  return static_cast<uint8_t>(byte);
}

double decode_srgb8(uint8_t byte) {
  return decode_srgb(byte / 255.0);
}

}  // namespace rayfarm
