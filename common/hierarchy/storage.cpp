#include "common/hierarchy/storage.h"

#include <algorithm>

#include "common/scene/tracing_state.h"

namespace rayfarm {

GridStorage& GridStorage::operator+=(const GridStorage& other) {
  empty_cells += other.empty_cells;
  full_cells += other.full_cells;
  pointers += other.pointers;
  return *this;
}

OctreeStorage& OctreeStorage::operator+=(const OctreeStorage& other) {
  nodes += other.nodes;
  pointers += other.pointers;
  hash_places += other.hash_places;
  return *this;
}

OctantStorage& OctantStorage::operator+=(const OctantStorage& other) {
  interior += other.interior;
  leaves += other.leaves;
  pointers += other.pointers;
  longest_list = std::max(longest_list, other.longest_list);
  return *this;
}

GridStorage storage_of(const Scene& scene, const Grid& grid) {
  GridStorage storage;
  for (size_t i = 0; i < grid.cell_count(); ++i) {
    const uint32_t pointers =
        scene.grid_cells[grid.first_cell + i + 1] - scene.grid_cells[grid.first_cell + i];
    ++(pointers == 0 ? storage.empty_cells : storage.full_cells);
    storage.pointers += pointers;
  }
  return storage;
}

OctreeStorage storage_of(const Scene& scene, uint32_t index) {
  const Octree& octree = scene.octrees[index];
  if (GrownOctree* const grown = scene.tracing ? scene.tracing->octrees[index].get() : nullptr) {
    const std::scoped_lock lock(grown->mutex);
    return {grown->nodes.size(), grown->pointer_count, grown->table.size()};
  }
  OctreeStorage storage{octree.node_count, 0, octree.place_count};
  for (const OctreeCell& cell : scene.octree_cells.subspan(octree.first_cell, octree.cell_count))
    storage.pointers += cell.pointer_count;
  return storage;
}

OctantStorage storage_of(const Scene& scene, const OctantTree& tree) {
  OctantStorage storage;
  for (const OctantVolume& volume : scene.octant_volumes.subspan(tree.first_volume, tree.volume_count)) {
    ++(volume.is_leaf() ? storage.leaves : storage.interior);
    storage.pointers += volume.pointer_count;
    storage.longest_list = std::max<uint64_t>(storage.longest_list, volume.pointer_count);
  }
  return storage;
}

GridStorage storage_of_grids(const Scene& scene) {
  GridStorage storage;
  for (const Grid& grid : scene.grids) storage += storage_of(scene, grid);
  return storage;
}

OctreeStorage storage_of_octrees(const Scene& scene) {
  OctreeStorage storage;
  for (uint32_t i = 0; i < scene.octrees.size(); ++i) storage += storage_of(scene, i);
  return storage;
}

OctantStorage storage_of_octants(const Scene& scene) {
  OctantStorage storage;
  for (const OctantTree& tree : scene.octant_trees) storage += storage_of(scene, tree);
  return storage;
}

}  // namespace rayfarm
