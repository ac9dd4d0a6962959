#pragma once
#include <array>
#include <cstddef>
#include <cstring>
#include <limits>

namespace rayfarm {

/// Four numbers side by side, of GCC's and Clang's own type: what compilers make of loops over four floats
/// depends on what stands around them.
using FourFloats = float __attribute__((vector_size(16)));
inline FourFloats load_four(const float* from) {
  FourFloats x;
  std::memcpy(&x, from, sizeof(x));
  return x;
}
inline void store_four(const FourFloats& x, float* to) {
  std::memcpy(to, &x, sizeof(x));
}

/// Bounds with four lanes. Empty ones have lo > hi.
struct alignas(16) Bounds {
  std::array<float, 4> lo, hi;

  static Bounds none() {
    Bounds b;
    b.lo.fill(std::numeric_limits<float>::infinity());
    b.hi.fill(-std::numeric_limits<float>::infinity());
    return b;
  }
  void grow(const float* other_lo, const float* other_hi) { grow(load_four(other_lo), load_four(other_hi)); }
  void grow(const FourFloats& other_lo, const FourFloats& other_hi) {
    const FourFloats l = load_four(lo.data()), h = load_four(hi.data());
    store_four(other_lo < l ? other_lo : l, lo.data());
    store_four(other_hi > h ? other_hi : h, hi.data());
  }
  void grow(const Bounds& b) { grow(b.lo.data(), b.hi.data()); }
  /// Keeps what lies in the other bounds too.
  void cut(const float* other_lo, const float* other_hi) {
    const FourFloats other_l = load_four(other_lo), other_h = load_four(other_hi);
    const FourFloats l = load_four(lo.data()), h = load_four(hi.data());
    store_four(other_l > l ? other_l : l, lo.data());
    store_four(other_h < h ? other_h : h, hi.data());
  }
  bool is_empty() const { return !(lo[0] <= hi[0] && lo[1] <= hi[1] && lo[2] <= hi[2]); }
  /// Half of the surface.
  float area() const {
    const float x = hi[0] - lo[0], y = hi[1] - lo[1], z = hi[2] - lo[2];
    return x * y + y * z + z * x;
  }
};

}  // namespace rayfarm
