#pragma once
// Half floats, in which texels are kept.
#include <Imath/half.h>

#include <cstdint>

namespace rayfarm {

inline double float_of_half(uint16_t bits) {
  return static_cast<double>(static_cast<float>(Imath::half(Imath::half::FromBits, bits)));
}
inline uint16_t half_of_float(double value) {
  return Imath::half(static_cast<float>(value)).bits();
}

}  // namespace rayfarm
