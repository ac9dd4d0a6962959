#pragma once
// Octrees of cells (Glassner 1984; thesis 2.6.2, 4.2.2): "an adaptive volume hierarchy". A cell is halved
// about its centre, into eight, while it holds much; a construction tree records how, and a hash table, or
// the tree itself, leads to the list of what a cell holds.
#include "common/hierarchy/builder.h"
#include "common/scene/scene.h"

namespace rayfarm {

/// Cells are divided, level by level, while an octree's lists name its primitives at most so often, 4096
/// times more in all.
inline constexpr size_t kMostPointersForEach = 32;

/// True if a node of the given size (OctreeNode) that holds so many `primitives` is to be divided;
/// `pointers`: those in all lists so far, to `all` primitives.
bool is_to_be_divided(const Octree& octree, uint32_t size, size_t primitives, size_t pointers, size_t all);

/// A node's part, without children yet.
OctreeNode make_octant(const OctreeNode& node, uint32_t octant);

/// Of those that have part in a node, the ones that have part in one of its octants. `bounds`: of the
/// source's primitives.
std::vector<uint32_t> those_in_octant(const Octree& octree, const OctreeNode& octant,
                                      const PrimitiveSource& source, std::span<const Box> bounds,
                                      std::span<const uint32_t> primitives);

/// Appends an octree over the primitives of `source`, of which `pointers` has the names, to `arrays`; returns
/// its index. One that is built while tracing is a single cell. options.octree_depth is at most
/// kMostOctreeDepth. Throws Stopped.
uint32_t build_octree(const PrimitiveSource& source, std::span<const PrimitivePointer> pointers,
                      const BuildOptions& options, SceneArrays<GrowingArray>& arrays);

/// Which octant about the centre a point is in: bits 1, 2, 4 for x, y, z that are not below it.
inline uint32_t octant_of(const OctreeNode& node, const std::array<uint32_t, 3>& point) {
  uint32_t octant = 0;
  for (size_t axis = 0; axis < 3; ++axis)
    octant |= static_cast<uint32_t>(point[axis] >= node.center[axis]) << axis;
  return octant;
}

}  // namespace rayfarm
