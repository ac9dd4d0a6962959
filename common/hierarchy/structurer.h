#pragma once
// The structurer: turns the builder's leaves into the records that the traverser tests eight at a time.
#include "common/hierarchy/builder.h"

namespace rayfarm {

/// The growing arrays that leaves are packed into.
struct LeafArrays {
  std::vector<VolumeNode>& nodes;
  std::vector<TriangleBlock>& triangle_blocks;
  std::vector<SphereBlock>& sphere_blocks;
  std::vector<PrimitiveId>& leaf_primitives;
};

/// A triangle's three vertices as they are stored and tested.
using TriangleVertices = std::array<glm::vec3, 3>;

/// The primitives of one part in one numbering: what the builder's references mean.
struct PartPrimitives {
  std::vector<PrimitiveId> ids;
  std::vector<TriangleVertices> triangles;  ///< of triangle ids, counted from first_triangle
  uint32_t first_triangle = 0;
};

/// Packs one leaf. A leaf of several kinds becomes a node with one child per kind.
ChildRef pack_leaf(std::span<const PrimitiveReference> references, const PartPrimitives& part,
                   std::span<const SphereRecord> spheres, LeafArrays& arrays);

}  // namespace rayfarm
