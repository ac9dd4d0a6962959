#pragma once
// Rays. The parameter t counts in lengths of the direction, which transforms leave as it is, so t means the
// same in every object's space.
#include <limits>

#include "common/math/vector.h"

namespace rayfarm {

struct Ray {
  Vec3 origin{0};
  Vec3 direction{0, 0, 1};                                 ///< any length > 0
  double t_max = std::numeric_limits<double>::infinity();  ///< hits lie in (0, t_max)
};

}  // namespace rayfarm
