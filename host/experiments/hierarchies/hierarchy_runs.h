#pragma once
// One set of rays, asked of every hierarchy: what they cost in visits, tests and time.
#include <string>
#include <vector>

#include "common/compile/compile.h"
#include "common/hierarchy/ray_log.h"
#include "common/hierarchy/walk_counts.h"

namespace rayfarm {

/// The rays of a picture by kinds, as the thesis and Weghorst tell them apart.
struct PictureRays {
  std::vector<Ray> eye, secondary, shadow;
  size_t size() const { return eye.size() + secondary.size() + shadow.size(); }
};

/// Those of frame 0 in Whitted's model, through the corners of `side_px` × `side_px` pixels.
PictureRays record_rays(const SceneDescription& scene, int side_px);

/// What a set of rays cost, all of them together.
struct KindCosts {
  size_t rays = 0;
  WalkCounts counts;
};

/// A hierarchy over a scene.
struct HierarchyRun {
  double build_s = 0;  ///< of compiling the scene
  double bytes =
      0;  ///< of what finds primitives: nodes, cells, lists, and leaves where they repeat primitives
  size_t primitives = 0;
  size_t pointers = 0;              ///< to primitives, from leaves or cells
  size_t interior = 0, leaves = 0;  ///< volumes
  size_t cells = 0, empty = 0;      ///< of grids; nodes of octrees; and cells without a primitive
  double thesis_bytes = 0;          ///< by the thesis's formulas (4.3.2); 0: it has none
  KindCosts eye, secondary, shadow;
  double ns_per_ray = 0;  ///< the least of three runs through all rays, one by one
};

/// Of all primitives once, as a list holds them.
double bytes_of_list(const SceneDescription& scene);

HierarchyRun run_hierarchy(const SceneDescription& scene, const BuildOptions& build, const PictureRays& rays,
                           double bytes_of_list);

}  // namespace rayfarm
