#pragma once
// What single rays cost in visits and tests (thesis 4.3, Weghorst, Hooper and Greenberg 1984), for
// experiments and tests alone: the same walk as closest_hit and any_hit, compiled once more with counters,
// and the same answers.
#include <array>

#include "common/hierarchy/frame_state.h"
#include "common/hierarchy/hit.h"
#include "common/hierarchy/items.h"

namespace rayfarm {

struct WalkCounts {
  uint64_t nodes = 0;           ///< of the object part and of parts
  uint64_t boxes = 0;           ///< tested; a node's are tested at once
  uint64_t cells = 0;           ///< of grids and octrees
  uint64_t empty_cells = 0;     ///< those among them that hold nothing
  uint64_t tree_nodes = 0;      ///< of octrees' construction trees, looked at to find cells
  uint64_t chain_steps = 0;     ///< entries of octrees' hash tables that names were compared with
  uint64_t saved_tests = 0;     ///< of primitives, that a mailbox made needless
  uint64_t last_hit_tests = 0;  ///< of what the ray before had hit
  uint64_t last_hits = 0;       ///< it is what this one hits, or it stops this shadow ray
  uint64_t coherent_rays = 0;   ///< that looked at lists of candidates
  uint64_t lists = 0;           ///< made for rays, those too that were too long to be kept
  uint64_t candidates = 0;      ///< looked at
  uint64_t leaves = 0;          ///< of volumes and lists
  uint64_t curved_leaves = 0;   ///< those among them of spheres and quadrics
  /// Cells that list 2^i to 2^(i + 1) - 1 primitives, and the primitives in their lists.
  std::array<uint64_t, 32> visits_by_fill{}, tests_by_fill{};
  std::array<uint64_t, kVolumeKinds> bounds{};  ///< bounding volumes tested, in the order of VolumeKind
  // Of octant trees: volumes whose spheres were tested (N_V of the thesis's Table 4.7), and those among them
  // that the ray misses, or reaches behind what it has hit.
  uint64_t interior_volumes = 0, leaf_volumes = 0, missed_volumes = 0;
  uint64_t elements = 0;  ///< objects and groups that were looked at, met or missed
  uint64_t groups = 0;    ///< of objects: what is in them was tested
  uint64_t objects = 0;   ///< whose primitives were tested
  // Primitives that were tested, or stand in leaves that were visited; a polygon is one, whatever it was cut
  // into.
  uint64_t triangles = 0, spheres = 0, polygons = 0, quadrics = 0;

  uint64_t bounding_volumes() const { return bounds[0] + bounds[1] + bounds[2] + bounds[3]; }
  uint64_t volumes() const { return interior_volumes + leaf_volumes; }
  uint64_t primitives() const { return triangles + spheres + polygons + quadrics; }
  WalkCounts& operator+=(const WalkCounts& other);
};

/// As closest_hit. `counts` grows.
Hit closest_hit_counted(const Scene& scene, const Pose& pose, const Ray& ray, WalkCounts& counts);
/// As closest_hit_among. `counts` grows.
Hit closest_hit_among_counted(const Scene& scene, const Pose& pose, std::span<const Item> items,
                              const Ray& ray, WalkCounts& counts);
/// As any_hit. `counts` grows.
bool any_hit_counted(const Scene& scene, const Pose& pose, const Ray& ray, WalkCounts& counts);

}  // namespace rayfarm
