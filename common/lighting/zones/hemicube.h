#pragma once
// "A hemi-cube is constructed around the surface. The objects in the scene are projected onto the hemi-cube"
// (the thesis's 2.2.5; Cohen and Greenberg 1985): here by a ray through each of its pixels.
#include <cstdint>

#include "common/math/vector.h"

namespace rayfarm {

struct HemicubePixel {
  Vec3 direction{0, 0, 1};  ///< unit, of its middle from the zone's; z along the normal
  uint64_t weight = 0;      ///< its form factor, in parts of 2^40: what all have is near to that
};

/// Half a cube of height 1 and side 2.
class Hemicube {
 public:
  /// `cells`: pixels along an edge of its top, at least 2. Its sides are half as high.
  explicit Hemicube(uint32_t cells) : cells_(cells), rows_(cells / 2) {}

  uint64_t count() const { return uint64_t{cells_} * (cells_ + 4 * rows_); }
  HemicubePixel operator[](uint64_t pixel) const;

 private:
  uint32_t cells_, rows_;
};

}  // namespace rayfarm
