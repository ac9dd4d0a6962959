#pragma once
// The object/volume hierarchy's volumes as the thesis stores them (4.2.1.2, 4.3.2): "The interior volume node
// … contains storage for a bounding sphere, a interior/leaf flag, a pointer to a child, and a sibling
// pointer. The leaf nodes … contain a bounding volume and a pointer to a list of data pointers".
#include "common/hierarchy/builder.h"
#include "common/scene/scene.h"

namespace rayfarm {

/// Appends a tree over the primitives of `source`, of which `pointers` has the names, to `arrays`; returns
/// its index. `source` is not empty. Throws Stopped, and TooManyCells.
uint32_t build_octant_tree(const PrimitiveSource& source, std::span<const PrimitivePointer> pointers,
                           const BuildOptions& options, SceneArrays<GrowingArray>& arrays);

/// The octants about a point that a ray passes, in its order (thesis 4.2.2, Table 4.2). Octants have the
/// numbers of Table 4.1: 4, 2, 1 for x, y, z below the point. From one to the next one of these is changed
/// (exclusive or; the "modulo 8" of the thesis's example does not lead to neighbours), in ascending order of
/// where the ray crosses the planes through the point. A ray that is parallel to one, or leaves it behind,
/// does not cross it.
struct OctantOrder {
  OctantOrder(const Vec3& center, const Vec3& origin, const Vec3& direction);

  size_t count = 1;
  std::array<uint32_t, 4> octants{};
  std::array<double, 4> entries{};  ///< how far the ray is where it enters each; 0 for the first
};

}  // namespace rayfarm
