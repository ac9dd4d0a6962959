#pragma once
// What builders ask of primitives: "the builder module asks for certain geometric characteristic from the
// primitive" (Shirley, Sung and Brown 1991, 2.3.2). Here of those that stand in the scene's arrays.
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
