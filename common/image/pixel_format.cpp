#include "common/image/pixel_format.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

#include "common/image/half_float.h"
#include "common/math/portable_math.h"

namespace rayfarm {

double decode_srgb(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : portable_pow((encoded + 0.055) / 1.055, 2.4);
}

double encode_srgb(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * portable_pow(linear, 1 / 2.4) - 0.055;
}

namespace {

/// How bytes are found without a power: made once, before main.
struct SrgbTable {
  /// The first guess is the byte at the lower end of one of these equal steps. They are shorter than the
  /// least distance of thresholds, 1 / (255 × 12.92), so the byte is that or the next one.
  static constexpr size_t kSteps = 4096;
  std::array<double, 256> thresholds;  ///< [i]: the smallest linear value that rounds to byte i + 1; ∞
  std::array<uint8_t, kSteps> guesses;

  SrgbTable() {
    for (size_t i = 0; i < 255; ++i) thresholds[i] = decode_srgb((static_cast<double>(i) + 0.5) / 255);
    thresholds[255] = std::numeric_limits<double>::infinity();
    for (size_t i = 0; i < kSteps; ++i)
      guesses[i] = static_cast<uint8_t>(
          std::upper_bound(thresholds.begin(), thresholds.end(), static_cast<double>(i) / kSteps) -
          thresholds.begin());
  }
};
const SrgbTable srgb;

}  // namespace

uint8_t encode_srgb8(double linear) {
  // Comparisons that become no branches: no one could predict them.
  const double positive = linear > 0 ? linear : 0, in_range = positive < 1 ? positive : 1 - 0x1p-53;
  const uint8_t guess = srgb.guesses[static_cast<size_t>(in_range * SrgbTable::kSteps)];
  return static_cast<uint8_t>(guess + static_cast<uint8_t>(srgb.thresholds[guess] <= in_range));
}

void encode_values(PixelFormat format, std::span<const double> values, std::byte* out) {
  switch (format) {
    case PixelFormat::rgb8:
      for (const double value : values) *out++ = static_cast<std::byte>(encode_srgb8(value));
      break;
    case PixelFormat::half_float:
      for (const double value : values) {
        const uint16_t bits = half_of_float(value);
        *out++ = static_cast<std::byte>(bits & 0xff);
        *out++ = static_cast<std::byte>(bits >> 8);
      }
      break;
    case PixelFormat::float32:
      for (const double value : values) {
        const auto bits = std::bit_cast<uint32_t>(static_cast<float>(value));
        for (size_t i = 0; i < 4; ++i) *out++ = static_cast<std::byte>(bits >> (8 * i) & 0xff);
      }
      break;
  }
}

double decode_srgb8(uint8_t byte) {
  return decode_srgb(byte / 255.0);
}

}  // namespace rayfarm
