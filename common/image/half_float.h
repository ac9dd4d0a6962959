#pragma once
// Half floats, in which pixels and texels are kept.
#include <Imath/half.h>

#include <algorithm>
#include <cstdint>

namespace rayfarm {

inline double float_of_half(uint16_t bits) {
  return static_cast<double>(static_cast<float>(Imath::half(Imath::half::FromBits, bits)));
}
/// The nearest half float. Beyond half's range a picture would hold infinity, which viewers and codecs handle
/// badly, so that the largest finite number stands there.
inline uint16_t half_of_float(double value) {
  return Imath::half(static_cast<float>(std::clamp(value, -65504.0, 65504.0))).bits();
}

}  // namespace rayfarm
