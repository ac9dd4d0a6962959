#pragma once
// The structurer (Shirley, Sung and Brown's word; of any Structure): turns the builder's leaves into the
// records that the traverser tests eight at a time.
#include "common/hierarchy/builder.h"
#include "common/shapes/sphere.h"

namespace rayfarm {

/// The growing arrays that leaves are packed into.
struct LeafArrays {
  LargeVector<VolumeNode>& nodes;
  LargeVector<TriangleBlock>& triangle_blocks;
  LargeVector<SphereBlock>& sphere_blocks;
  LargeVector<PrimitiveId>& leaf_primitives;
};

/// A triangle's three vertices as they are stored and tested.
using TriangleVertices = std::array<glm::vec3, 3>;

/// The primitives of one part in one numbering: what the builder's references mean. A polygon that was cut
/// into triangles stands here once for each of them.
struct PartPrimitives {
  LargeVector<PrimitiveId> ids;
  LargeVector<uint32_t> triangle_of;  ///< index into triangles, kNone for what is tested as it is
  LargeVector<TriangleVertices> triangles;

  void add(PrimitiveId id) {
    ids.push_back(id);
    triangle_of.push_back(kNone);
  }
  void add_triangle(PrimitiveId id, const TriangleVertices& vertices) {
    ids.push_back(id);
    triangle_of.push_back(static_cast<uint32_t>(triangles.size()));
    triangles.push_back(vertices);
  }
};

/// Packs one leaf. A leaf of several kinds becomes a node with one child per kind.
ChildRef pack_leaf(std::span<const PrimitiveReference> references, const PartPrimitives& part,
                   std::span<const SphereRecord> spheres, LeafArrays& arrays);

}  // namespace rayfarm
