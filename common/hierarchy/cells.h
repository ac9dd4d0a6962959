#pragma once
// What cells of grids and octrees have in common: boxes that list the primitives with a part in them.
#include "common/hierarchy/builder.h"

namespace rayfarm {

/// The bounds of all primitives; of what is flat, with some thickness all the same.
Box thick_bounds(const PrimitiveSource& source);

/// The box, larger by what rounding on a ray's way through it may come to.
Box with_margin(const Box& box);

/// How far from its surface a quadric in the box may be hit by a ray that is not too far away.
double surface_error(const Box& box);

/// True if rounding may come to more for a ray from there. `magnitude`: the box's largest coordinate.
bool is_too_far(double magnitude, const Vec3& origin);

/// More cells or pointers than indices can tell apart.
class TooManyCells : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws TooManyCells if there are too many `things`; `option` makes them fewer.
void check_count(uint64_t count, const char* things, const char* option);

}  // namespace rayfarm
