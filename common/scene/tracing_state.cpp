#include "common/scene/tracing_state.h"

#include <algorithm>

namespace rayfarm {

GrownOctree::GrownOctree(const Scene& scene, const Octree& octree) : table(octree.place_count) {
  // What was compiled is one cell.
  const OctreeCell& cell = scene.octree_cells[octree.first_cell];
  const auto all = scene.primitive_pointers.subspan(cell.first_pointer, cell.pointer_count);
  root = &nodes.emplace_back();
  root->cube = scene.octree_nodes[octree.first_node];
  root->primitives.assign(all.begin(), all.end());
  primitive_count = pointer_count = all.size();
}

TracingState::TracingState(const Scene& scene) {
  static std::atomic<uint64_t> last_number = 0;
  number = ++last_number;
  for (const Octree& octree : scene.octrees)
    octrees.push_back(octree.build == OctreeBuild::tracing ? std::make_unique<GrownOctree>(scene, octree)
                                                           : nullptr);
}

std::shared_ptr<TracingState> make_tracing_state(const Scene& scene) {
  const bool is_grown = std::any_of(scene.octrees.begin(), scene.octrees.end(), [](const Octree& octree) {
    return octree.build == OctreeBuild::tracing;
  });
  if (!is_grown && scene.head().has_last_hit == 0 && scene.head().ray_coherence == 0) return nullptr;
  return std::make_shared<TracingState>(scene);
}

}  // namespace rayfarm
