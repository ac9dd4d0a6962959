#include "common/hierarchy/cells.h"

#include <fmt/core.h>

namespace rayfarm {
namespace {

/// Of a box's largest coordinate.
constexpr double kMargin = 1e-9;

/// Of a coordinate on a ray's way: fewer, each of half a last bit.
constexpr double kRoundings = 16;

}  // namespace

Box thick_bounds(const PrimitiveSource& source) {
  Box box;
  for (uint32_t i = 0; i < source.size(); ++i) box.grow(source.bounds(i));
  box.hi = glm::max(box.hi, box.lo + Vec3(1e-6 * box.magnitude() + std::numeric_limits<double>::min()));
  return box;
}

Box with_margin(const Box& box) {
  const Vec3 margin(kMargin * box.magnitude());
  return {box.lo - margin, box.hi + margin};
}

double surface_error(const Box& box) {
  constexpr double kQuadricRoundings = 128;  // of the origin's largest coordinate: what intersect() promises
  return kQuadricRoundings / kRoundings * kMargin * box.magnitude();
}

bool is_too_far(double magnitude, const Vec3& origin) {
  return kRoundings * std::numeric_limits<double>::epsilon() * (max_magnitude(origin) + magnitude) >
         kMargin * magnitude;
}

void check_count(uint64_t count, const char* things, const char* option) {
  constexpr uint64_t kMost = 1ull << 31;
  if (count > kMost)
    throw TooManyCells(
        fmt::format("the scene comes to more than {} {}; choose less with {}, or another hierarchy", kMost,
                    things, option));
}

}  // namespace rayfarm
