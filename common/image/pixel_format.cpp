#include "common/image/pixel_format.h"

#include <algorithm>
#include <array>
#include <bit>

#include "common/image/half_float.h"
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

void encode_value(PixelFormat format, double value, std::byte* out) {
  switch (format) {
    case PixelFormat::rgb8:
      *out = static_cast<std::byte>(encode_srgb8(value));
      break;
    case PixelFormat::half_float: {
      const uint16_t bits = half_of_float(value);
      out[0] = static_cast<std::byte>(bits & 0xff);
      out[1] = static_cast<std::byte>(bits >> 8);
      break;
    }
    case PixelFormat::float32: {
      const auto bits = std::bit_cast<uint32_t>(static_cast<float>(value));
      for (size_t i = 0; i < 4; ++i) out[i] = static_cast<std::byte>(bits >> (8 * i) & 0xff);
      break;
    }
  }
}

double decode_value(PixelFormat format, const std::byte* in) {
  switch (format) {
    case PixelFormat::rgb8:
      return decode_srgb8(static_cast<uint8_t>(*in));
    case PixelFormat::half_float:
      return float_of_half(
          static_cast<uint16_t>(static_cast<unsigned>(in[0]) | static_cast<unsigned>(in[1]) << 8));
    case PixelFormat::float32: {
      uint32_t bits = 0;
      for (size_t i = 0; i < 4; ++i) bits |= static_cast<uint32_t>(in[i]) << (8 * i);
      return static_cast<double>(std::bit_cast<float>(bits));
    }
  }
  return 0;
}

}  // namespace rayfarm
