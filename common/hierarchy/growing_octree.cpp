#include "common/hierarchy/growing_octree.h"

#include <numeric>

#include "common/hierarchy/octree.h"
#include "common/hierarchy/primitive_bounds.h"

namespace rayfarm {
namespace {

using State = GrownNode::State;

/// The mutex is held. From now on others may find it.
void make_cell(GrownOctree& grown, GrownNode& node) {
  if (!grown.table.empty()) {
    std::atomic<GrownNode*>& first = grown.table[node.name % grown.table.size()];
    node.next = first.load(std::memory_order_relaxed);
    first.store(&node, std::memory_order_release);
  }
  node.state.store(State::cell, std::memory_order_release);
}

/// The mutex is held.
void divide(const Scene& scene, const Octree& octree, GrownOctree& grown, GrownNode& node) {
  const PointedPrimitives source(scene, octree.box(), node.primitives);
  std::vector<uint32_t> all(node.primitives.size());
  std::iota(all.begin(), all.end(), 0);
  std::vector<Box> bounds;
  for (const uint32_t i : all) bounds.push_back(source.bounds(i));
  GrownNode** end = &node.child;
  for (uint32_t octant = 0; octant < 8; ++octant) {
    const OctreeNode cube = make_octant(node.cube, octant);
    const std::vector<uint32_t> inside = those_in_octant(octree, cube, source, bounds, all);
    if (inside.empty()) continue;
    GrownNode& child = grown.nodes.emplace_back();
    child.cube = cube;
    child.name = 8 * node.name + octant;
    for (const uint32_t i : inside) child.primitives.push_back(node.primitives[i]);
    grown.pointer_count += inside.size();
    *end = &child;
    end = &child.sibling;
  }
  grown.pointer_count -= node.primitives.size();
  node.primitives = {};
  node.state.store(State::divided, std::memory_order_release);
}

}  // namespace

GrownNode::State enter_open_node(const Scene& scene, const Octree& octree, GrownOctree& grown,
                                 GrownNode& node) {
  const std::scoped_lock lock(grown.mutex);
  if (node.state.load(std::memory_order_relaxed) != State::open)
    return node.state.load(std::memory_order_relaxed);  // another was faster
  if (is_to_be_divided(octree, node.cube.size, node.primitives.size(), grown.pointer_count,
                       grown.primitive_count))
    divide(scene, octree, grown, node);
  else
    make_cell(grown, node);
  return node.state.load(std::memory_order_relaxed);
}

}  // namespace rayfarm
