#pragma once
// What is known of a pixel while its samples come, and when it needs no more of them.
#include <cmath>
#include <span>
#include <vector>

#include "common/math/vector.h"

namespace rayfarm {

/// Samples are added in their order, so that it does not matter in how many pieces of work they come.
struct RunningPixel {
  Color sum = Color(0);      ///< of the samples, each times its weight
  Color squares = Color(0);  ///< Σ (sample - mean)², kept where there is a target for noise
  uint32_t samples = 0;

  /// There must be a sample.
  Color mean() const { return sum / static_cast<double>(samples); }
  void add(const Color& sample) {
    sum += sample;
    ++samples;
  }
  /// The same, with the squares (Welford 1962).
  void add_with_squares(const Color& sample) {
    const Color from_mean = samples == 0 ? Color(0) : sample - mean();
    add(sample);
    squares += from_mean * (sample - mean());
  }
};

/// How much noise a picture may have: the standard error of a pixel's mean as a display shows it, from its
/// own samples alone, so that the choice does not depend on how the picture is cut.
class NoiseTarget {
 public:
  /// Pixels are looked at after so many samples, and each time after so many more. Fewer tell too little of
  /// how samples scatter: a pixel whose first are all alike counts as free of noise.
  static constexpr uint32_t kBatch = 16;

  /// `error`: of each channel, in parts of the range from black to white in sRGB's encoding (1/255: a step of
  /// 8 bits); 0: there is no target. `exposure`: what pictures hold per light.
  NoiseTarget(double error, double exposure) : error_(error), exposure_(exposure) {}

  bool is_set() const { return error_ > 0; }
  /// True if this is where a pixel is looked at, and all its channels' errors are small enough: half of what
  /// lies between the mean less its standard error and the mean plus it, both cut off where the display ends.
  bool is_met(const RunningPixel& pixel) const;

 private:
  double error_, exposure_;
};

/// What a pixel weighs between the passes of a picture. `with_squares`: if they are kept, and so the numbers
/// of samples differ.
constexpr size_t bytes_of_running(bool with_squares) {
  constexpr size_t kColorBytes = 3 * sizeof(uint64_t);
  return with_squares ? 2 * kColorBytes + sizeof(uint32_t) : kColorBytes;
}
/// Little-endian, one pixel after the other.
std::vector<std::byte> encode_running(std::span<const RunningPixel> pixels, bool with_squares);
/// `samples`: that pixels have where their numbers are not kept. Throws std::runtime_error if the bytes are
/// not those of so many pixels.
void decode_running(std::span<const std::byte> bytes, bool with_squares, uint32_t samples,
                    std::span<RunningPixel> pixels);

}  // namespace rayfarm
