#pragma once
// What the leaves of volumes refer to. Spatial splits let several refer to one primitive.
#include <cmath>

#include "common/scene/scene.h"

namespace rayfarm {

/// Calls visit(id) for each reference of a leaf to a primitive.
template <typename Visitor>
void for_each_reference(const Scene& scene, Visitor visit) {
  for (const TriangleBlock& block : scene.triangle_blocks)
    for (const PrimitiveId id : block.primitives)
      if (id != kNoPrimitive) visit(id);
  for (const SphereBlock& block : scene.sphere_blocks)
    for (size_t lane = 0; lane < block.spheres.size(); ++lane)
      if (!std::isnan(block.center[0][lane]))
        visit(make_primitive_id(PrimitiveKind::sphere, block.spheres[lane]));
  for (const PrimitiveId id : scene.leaf_primitives) visit(id);
}

inline size_t count_references(const Scene& scene) {
  size_t count = 0;
  for_each_reference(scene, [&](PrimitiveId) { ++count; });
  return count;
}

}  // namespace rayfarm
