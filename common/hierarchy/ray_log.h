#pragma once
// The rays that a scene was asked about, for experiments that ask other hierarchies the same.
#include <vector>

#include "common/math/ray.h"

namespace rayfarm {

/// In the order in which they were traced. A Scene with a log (Scene::ray_log) belongs to one thread.
struct RayLog {
  std::vector<Ray> closest;  ///< for what is hit first
  std::vector<Ray> any;      ///< for whether anything is
};

}  // namespace rayfarm
