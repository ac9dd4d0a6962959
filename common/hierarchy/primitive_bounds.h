#pragma once
// What builders ask of primitives: "the builder module asks for certain geometric characteristic from the
// primitive" (Shirley, Sung and Brown 1991, 2.3.2). Here of those that stand in the scene's arrays.
#include <cmath>
#include <span>

#include "common/hierarchy/builder.h"
#include "common/scene/scene.h"

namespace rayfarm {

/// Of all but triangles and meshes' faces.
Box bounds_of(const Scene& scene, PrimitiveId primitive);
/// Of all; what was cut into triangles is one.
Box bounds_of(const Scene& scene, PrimitivePointer pointer);
/// The box of its piece inside `cell`, empty if there is none. May be larger, never smaller.
Box clipped_to(const Scene& scene, PrimitiveId primitive, const Box& cell);

uint32_t material_of(const Scene& scene, PrimitiveId primitive);

/// Calls visit(id, block_lane) for all that a part's arrays name; some more than once.
template <typename Visit>
void for_each_named(const Scene& scene, const Part& part, Visit visit) {
  for (uint32_t b = 0; b < part.triangle_block_count; ++b)
    for (uint32_t lane = 0; lane < 8; ++lane) {
      const uint32_t block = part.first_triangle_block + b;
      const TriangleBlock& triangles = scene.triangle_blocks[block];
      if (!std::isnan(triangles.vertices[0][0][lane])) visit(triangles.primitives[lane], 8 * block + lane);
    }
  for (const SphereBlock& block :
       scene.sphere_blocks.subspan(part.first_sphere_block, part.sphere_block_count))
    for (const uint32_t sphere : block.spheres)
      if (sphere != kNone) visit(make_primitive_id(PrimitiveKind::sphere, sphere), kNone);
  for (const PrimitiveId id :
       scene.leaf_primitives.subspan(part.first_leaf_primitive, part.leaf_primitive_count))
    if (id.kind() != PrimitiveKind::collection) visit(id, kNone);
}

/// Primitives as lists of cells name them: what was cut into triangles is one.
class PointedPrimitives : public PrimitiveSource {
 public:
  /// Those of a collection with these bounds. Scene and pointers must stay where they are.
  PointedPrimitives(const Scene& scene, const Box& bounds, std::span<const PrimitivePointer> pointers);
  size_t size() const override { return pointers_.size(); }
  Box bounds(uint32_t primitive) const override;
  Box clipped(uint32_t primitive, const Box& cell) const override;

 private:
  const Scene& scene_;
  std::span<const PrimitivePointer> pointers_;
  double ray_error_;  ///< how far from their surfaces primitives may be hit
};

/// The corners of the triangles that a primitive was cut into, the first of which `pointer` names: three of
/// each.
std::vector<Vec3> corners_of(const Scene& scene, PrimitivePointer pointer);

}  // namespace rayfarm
