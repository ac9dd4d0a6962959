#pragma once
// One set of rays, asked of every hierarchy: what they cost in visits, tests and time.
#include <string>
#include <vector>

#include "common/compile/compile.h"
#include "common/hierarchy/ray_log.h"
#include "common/hierarchy/walk_counts.h"
#include "common/lighting/ray_counts.h"

namespace rayfarm {

/// The rays of a picture by kinds, as the thesis and Weghorst tell them apart.
struct PictureRays {
  std::vector<Ray> eye, secondary, shadow;
  RayCounts counts;  ///< as the renderer tells them apart
  size_t size() const { return eye.size() + secondary.size() + shadow.size(); }
};

/// Those of frame 0 in Whitted's model, through the corners of `side_px` × `side_px` pixels.
PictureRays record_rays(const SceneDescription& scene, int side_px);

/// Every `n`th ray of each kind.
PictureRays every_nth(const PictureRays& rays, size_t n);

/// The three types of the thesis's Figure 4.6. Ray 1 "strikes an object in the first volume tested", ray 2
/// "travels through a few empty volumes before striking an object or leaving the hierarchy", ray 3 passes
/// "through empty and full volumes before". Volumes are cells, or leaves of volumes: they are never empty.
using RayTypes = std::array<uint64_t, 3>;
/// The type, from 0, of a ray that visited so many.
size_t type_of_ray(uint64_t empty_volumes, uint64_t full_volumes, bool is_hit);

/// What a set of rays cost, all of them together.
struct KindCosts {
  size_t rays = 0;
  WalkCounts counts;
  RayTypes types{};
  uint64_t hits = 0;
  uint64_t answers = 0;  ///< a digest of what was hit, and where: the same of all hierarchies
};

/// What is known of a scene whatever its hierarchy is.
struct SceneFacts {
  double list_bytes = 0;       ///< of all primitives once
  double list_cpu_s = 0;       ///< of compiling it without a hierarchy
  size_t object_nodes = 0;     ///< objects and groups (Table 4.5)
  size_t object_pointers = 0;  ///< from groups to what is in them
};
SceneFacts look_at_scene(const SceneDescription& scene, int builds);

/// A hierarchy over a scene.
struct HierarchyRun {
  double build_cpu_s = 0;  ///< of all threads, beyond compiling a list: the median of the builds
  double bytes =
      0;  ///< of what finds primitives: nodes, cells, lists, and leaves where they repeat primitives
  size_t primitives = 0;
  size_t pointers = 0;                     ///< to primitives, from leaves or cells; of objects: to objects
  size_t interior = 0, leaves = 0;         ///< volumes
  size_t cells = 0, empty = 0;             ///< of grids; nodes of octrees; and cells without a primitive
  size_t full_lists = 0;                   ///< cells or leaves that list primitives
  size_t quadric_cells = 0;                ///< cells that list quadrics alone
  std::array<size_t, 32> cells_by_fill{};  ///< cells of grids that list 2^i to 2^(i + 1) - 1 primitives
  size_t objects = 0;                      ///< and groups, of a hierarchy of objects
  double thesis_bytes = 0;                 ///< by the thesis's formulas (4.3.2)
  KindCosts eye, secondary, shadow;
  double ns_per_ray = 0;  ///< the least of the passes, chunk by chunk of the rays, one by one

  KindCosts all() const;
  /// Cells; nodes and leaves; or objects and groups that were looked at: N_V, or N_O.
  double volumes_per_ray() const;
  double primitives_per_ray() const;  ///< N_P
};

/// How much is measured.
struct Effort {
  int builds = 1, passes = 3;
};

HierarchyRun run_hierarchy(const SceneDescription& scene, const BuildOptions& build, const PictureRays& rays,
                           const SceneFacts& facts, const Effort& effort);

}  // namespace rayfarm
