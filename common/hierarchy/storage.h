#pragma once
// What hierarchies of lists weigh as the thesis counts it (Tables 4.4 and 4.5): its nodes and pointers, not
// this program's records.
#include "common/scene/scene.h"

namespace rayfarm {

/// "An array of pointers", and those in the lists: 4 bytes each.
struct GridStorage {
  uint64_t empty_cells = 0, full_cells = 0, pointers = 0;
  uint64_t bytes() const { return 4 * (empty_cells + full_cells + pointers); }
  GridStorage& operator+=(const GridStorage& other);
};

/// Nodes of 24 bytes; pointers, those of the hash table too, of 4.
struct OctreeStorage {
  uint64_t nodes = 0, pointers = 0, hash_places = 0;
  uint64_t bytes() const { return 24 * nodes + 4 * (pointers + hash_places); }
  OctreeStorage& operator+=(const OctreeStorage& other);
};

/// Interior volumes of 24 bytes, leaves of 20, pointers of 4.
struct OctantStorage {
  uint64_t interior = 0, leaves = 0, pointers = 0;
  uint64_t longest_list = 0;  ///< pointers of one leaf
  uint64_t bytes() const { return 24 * interior + 20 * leaves + 4 * pointers; }
  OctantStorage& operator+=(const OctantStorage& other);
};

GridStorage storage_of(const Scene& scene, const Grid& grid);
/// Of the octree with this index; of one that is built while tracing what has been made so far.
OctreeStorage storage_of(const Scene& scene, uint32_t octree);
OctantStorage storage_of(const Scene& scene, const OctantTree& tree);
/// Of all together.
GridStorage storage_of_grids(const Scene& scene);
OctreeStorage storage_of_octrees(const Scene& scene);
OctantStorage storage_of_octants(const Scene& scene);

}  // namespace rayfarm
