#pragma once
// Values of pixels as they are kept, sent and written. Conversion happens once, on the node, so that every
// wire and every file sees the same bytes.
#include <cstddef>
#include <cstdint>
#include <span>

namespace rayfarm {

/// What a channel's values are kept as. rgb8: sRGB-encoded bytes (IEC 61966-2-1). half_float, float32:
/// linear, little-endian.
enum class PixelFormat : uint8_t { rgb8, half_float, float32 };

/// Of one value.
constexpr size_t bytes_of(PixelFormat format) {
  return format == PixelFormat::rgb8 ? 1 : format == PixelFormat::half_float ? 2 : 4;
}
constexpr const char* name_of(PixelFormat format) {
  return format == PixelFormat::rgb8 ? "rgb8" : format == PixelFormat::half_float ? "half" : "float";
}

/// The sRGB byte of a linear value; below 0 and NaN give 0, above 1 gives 255. The same on every machine.
uint8_t encode_srgb8(double linear);
/// The linear value that an sRGB byte stands for.
double decode_srgb8(uint8_t byte);

/// Writes linear values at `out`, one after the other.
void encode_values(PixelFormat format, std::span<const double> values, std::byte* out);

/// The linear value of an encoded one in [0, 1], and the other way round.
double decode_srgb(double encoded);
double encode_srgb(double linear);

}  // namespace rayfarm
