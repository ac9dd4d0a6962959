#pragma once
// An environment of Weghorst, Hooper and Greenberg, rendered with each of their combinations: what each phase
// took, and what was tested.
#include <string>
#include <vector>

#include "common/compile/compile.h"
#include "common/hierarchy/bounding_volumes.h"
#include "common/hierarchy/walk_counts.h"
#include "common/lighting/ray_counts.h"

namespace rayfarm {

/// What a phase's rays cost, all of them together.
struct PhaseCost {
  uint64_t rays = 0;
  WalkCounts counts;
  double s = 0;  ///< asked one after the other, on one core
};

struct CombinationRun {
  std::string name;
  double render_s = 0;  ///< of the whole picture, from the first ray to its pixels
  double buffer_s = 0;  ///< of making the item buffer; 0: there is none
  double write_s = 0;   ///< of the picture's file
  PhaseCost eye, secondary, shadow;
  uint64_t differing_pixels = 0;  ///< from those of an ordinary search

  double tree_s() const { return eye.s + secondary.s; }
  /// All that the picture's time is beside what was measured apart. Never less than nothing: the parts were
  /// measured in runs of their own.
  double colour_s() const {
    const double rest = render_s - tree_s() - shadow.s - buffer_s;
    return rest > 0 ? rest : 0;
  }
  double total_s() const { return render_s + write_s; }
  double search_s() const { return tree_s() + shadow.s + buffer_s; }
};

struct EnvironmentRun {
  RayCounts rays;
  std::vector<CombinationRun> runs;  ///< in Weghorst's order
  double primitive_ns = 0;           ///< I of Equation 1 for each of an item's primitives
  // Pictures that stay the same to the byte, with the clusters and selected volumes of SH.
  double bound_s = 0;         ///< the item buffer's hits bound an ordinary search
  double light_buffer_s = 0;  ///< the lights have item buffers, too; the eye's is trusted
  uint64_t shadowed_by_items = 0;
  double depth_above_tenth = 0;  ///< the average depth of trees if rays of a weight below 0.1 are cut
};

/// Of a picture in Whitted's model, with a ray through each corner of width × height pixels. `depth`: of ray
/// trees; 0: adaptive. `runs`: of which the least time counts. Writes its pictures to `scratch`, an image's
/// name.
EnvironmentRun run_environment(const SceneDescription& scene, int frame, uint32_t depth, int width_px,
                               int height_px, int runs, const std::string& scratch);

/// The weight below which rays are not traced where the depth is adaptive; Weghorst, Hooper and Greenberg
/// don't state theirs.
inline constexpr double kAdaptiveWeight = 0.02;

/// b·B + i·I (Equation 1), in ns: by the factors of bounding volumes, and of primitives.
double cost_ns(const WalkCounts& counts, double primitive_ns);

/// The time of looking at an item from one side with a bounding box, and with a sphere (Figure 2).
struct ViewCost {
  double box_s = 0, sphere_s = 0;
  double box_ns = 0, sphere_ns = 0;  ///< by Equation 1
};
ViewCost compare_bounds(const SceneDescription& scene, int frame, int width_px, int height_px, int runs);

}  // namespace rayfarm
