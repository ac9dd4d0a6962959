#pragma once
#include <array>
#include <cstddef>
#include <limits>

namespace rayfarm {

/// Bounds with four lanes, so that compilers use one instruction for all of them. Empty ones have lo > hi.
struct alignas(16) Bounds {
  std::array<float, 4> lo, hi;

  static Bounds none() {
    Bounds b;
    b.lo.fill(std::numeric_limits<float>::infinity());
    b.hi.fill(-std::numeric_limits<float>::infinity());
    return b;
  }
  void grow(const float* other_lo, const float* other_hi) {
    for (size_t i = 0; i < 4; ++i) lo[i] = other_lo[i] < lo[i] ? other_lo[i] : lo[i];
    for (size_t i = 0; i < 4; ++i) hi[i] = other_hi[i] > hi[i] ? other_hi[i] : hi[i];
  }
  void grow(const Bounds& b) { grow(b.lo.data(), b.hi.data()); }
  /// Keeps what lies in the other bounds too.
  void cut(const float* other_lo, const float* other_hi) {
    for (size_t i = 0; i < 4; ++i) lo[i] = other_lo[i] > lo[i] ? other_lo[i] : lo[i];
    for (size_t i = 0; i < 4; ++i) hi[i] = other_hi[i] < hi[i] ? other_hi[i] : hi[i];
  }
  bool is_empty() const { return !(lo[0] <= hi[0] && lo[1] <= hi[1] && lo[2] <= hi[2]); }
  /// Half of the surface.
  float area() const {
    const float x = hi[0] - lo[0], y = hi[1] - lo[1], z = hi[2] - lo[2];
    return x * y + y * z + z * x;
  }
};

}  // namespace rayfarm
