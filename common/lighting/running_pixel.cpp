#include "common/lighting/running_pixel.h"

#include <algorithm>
#include <bit>
#include <stdexcept>

#include "common/image/pixel_format.h"

namespace rayfarm {
namespace {

double shown(double linear) {
  return encode_srgb(std::clamp(linear, 0.0, 1.0));
}

template <typename T>
void append(T value, std::vector<std::byte>& out) {
  for (size_t i = 0; i < sizeof(T); ++i) out.push_back(static_cast<std::byte>(value >> (8 * i) & 0xff));
}
void append(const Color& color, std::vector<std::byte>& out) {
  for (int c = 0; c < 3; ++c) append(std::bit_cast<uint64_t>(color[c]), out);
}

template <typename T>
T take(const std::byte*& in) {
  T value = 0;
  for (size_t i = 0; i < sizeof(T); ++i) value |= static_cast<T>(*in++) << (8 * i);
  return value;
}
Color take_color(const std::byte*& in) {
  Color color;
  for (int c = 0; c < 3; ++c) color[c] = std::bit_cast<double>(take<uint64_t>(in));
  return color;
}

}  // namespace

bool NoiseTarget::is_met(const RunningPixel& pixel) const {
  if (pixel.samples == 0 || pixel.samples % kBatch != 0) return false;
  const double n = pixel.samples;
  const Color mean = pixel.mean();
  for (int c = 0; c < 3; ++c) {
    if (pixel.squares[c] == 0) continue;
    const double error = exposure_ * std::sqrt(pixel.squares[c] / (n * (n - 1))),
                 middle = exposure_ * mean[c];
    if (!std::isfinite(middle) || !std::isfinite(error)) return false;
    if (0.5 * (shown(middle + error) - shown(middle - error)) > error_) return false;
  }
  return true;
}

std::vector<std::byte> encode_running(std::span<const RunningPixel> pixels, bool with_squares) {
  std::vector<std::byte> bytes;
  bytes.reserve(pixels.size() * bytes_of_running(with_squares));
  for (const RunningPixel& pixel : pixels) {
    append(pixel.sum, bytes);
    if (!with_squares) continue;
    append(pixel.squares, bytes);
    append(pixel.samples, bytes);
  }
  return bytes;
}

void decode_running(std::span<const std::byte> bytes, bool with_squares, uint32_t samples,
                    std::span<RunningPixel> pixels) {
  if (bytes.size() != pixels.size() * bytes_of_running(with_squares))
    throw std::runtime_error("what a pass goes on from is not of so many pixels");
  const std::byte* in = bytes.data();
  for (RunningPixel& pixel : pixels) {
    pixel.sum = take_color(in);
    pixel.samples = samples;
    if (!with_squares) continue;
    pixel.squares = take_color(in);
    pixel.samples = take<uint32_t>(in);
    if (pixel.samples == 0 || pixel.samples > samples)
      throw std::runtime_error("what a pass goes on from has pixels with more samples than were taken");
  }
}

}  // namespace rayfarm
