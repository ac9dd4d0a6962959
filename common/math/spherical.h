#pragma once
// Directions as angles; y is up.
#include <numbers>

#include "common/math/portable_math.h"
#include "common/math/vector.h"

namespace rayfarm {

/// The angle about y from x towards z, as a part of the whole turn: in [0, 1].
inline double longitude(double x, double z) {
  const double r = std::sqrt(x * x + z * z);
  if (!(r > 0)) return 0;
  const double angle = portable_acos(x / r) / (2 * std::numbers::pi);
  return z < 0 ? 1 - angle : angle;
}

}  // namespace rayfarm
