#pragma once
// Primitives as the author of a scene counts them (thesis, Table 4.3): polygons of any number of corners,
// also those of meshes; a box is six.
#include "common/description/scene_description.h"

namespace rayfarm {

struct PrimitiveCounts {
  uint64_t polygons = 0, spheres = 0, quadrics = 0;

  PrimitiveCounts& operator+=(const PrimitiveCounts& other) {
    polygons += other.polygons;
    spheres += other.spheres;
    quadrics += other.quadrics;
    return *this;
  }
};

/// Of the object itself, without its children.
PrimitiveCounts count_primitives(const SceneDescription& scene, const ObjectDescription& object);

/// Of the scene, those of an object once for every copy of it. The description must be valid.
PrimitiveCounts count_copies(const SceneDescription& scene);

}  // namespace rayfarm
