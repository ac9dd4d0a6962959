#pragma once
// Whether anything of a scene lies in a convex region: what a camera can see, or what a lamp can light.
#include <span>

#include "common/scene/scene.h"

namespace rayfarm {

/// Where n·p > d.
struct HalfSpace {
  Vec3 n{0};
  double d = 0;
};

enum class Presence { none, possible, certain };

/// Looks for primitives in the region that lies in all the half spaces, at the first frame's poses. None:
/// each lies outside one of them. Certain: a corner or a sphere's centre is inside. Each box or block of
/// primitives that is looked at takes one from `patience`; when none is left the answer is possible.
Presence find_in_region(const Scene& scene, std::span<const HalfSpace> region, size_t& patience);

}  // namespace rayfarm
