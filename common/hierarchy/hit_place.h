#pragma once
// Where what a ray hit stands, so that it can be tested again.
#include "common/scene/hierarchy_records.h"

namespace rayfarm {

struct HitPlace {
  uint32_t instance = kNone;  ///< kNone: nothing was hit
  PrimitivePointer place{};   ///< of what was cut into triangles, the one that was hit
  friend bool operator==(const HitPlace& a, const HitPlace& b) {
    return a.instance == b.instance && a.place.bits == b.place.bits;
  }
};

}  // namespace rayfarm
