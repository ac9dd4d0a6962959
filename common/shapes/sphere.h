#pragma once
#include <cstdint>

#include "common/math/vector.h"

namespace rayfarm {

struct SphereRecord {
  Vec3 center{0};
  double radius = 1;
  uint32_t material = 0;
  uint32_t padding = 0;
};

}  // namespace rayfarm
