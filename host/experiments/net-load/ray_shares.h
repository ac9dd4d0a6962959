#pragma once
// Which rays a picture takes: their kinds, by the statistics of real renders; and, of eye rays, the three
// types of the thesis's Figure 4.6, on whose shares the speed of volume hierarchies depends (section 4.3.3).
#include <array>
#include <string>
#include <vector>

#include "common/lighting/ray_counts.h"
#include "host/experiments/net-load/local_runs.h"

namespace rayfarm {

/// Figure 4.6: ray 1 "strikes an object in the first volume tested", ray 2 "travels through a few empty
/// volumes before striking an object or leaving the hierarchy", ray 3 passes "through empty and full volumes
/// before". The object/volume hierarchy holds no empty volume; what lies between its boxes is empty space. So
/// a ray is of type 1 if it strikes in the first full volume (leaf) that it tests, of type 2 if it tests
/// none, of type 3 if it tests others in vain.
struct VolumeTypes {
  std::array<uint64_t, 3> eye_rays{};  ///< of types 1, 2, 3
};

struct RayShares {
  std::string scene;
  RayCounts kinds;
  VolumeTypes types;
};

/// Renders each scene once, in Whitted's model. Images 1 and 3 are written beside the runs.
std::vector<RayShares> measure_ray_shares(const LocalRuns& runs, const std::string& scenes, int width_px);

/// Counts the types of the eye rays through the pixels' centres, in the thesis's hierarchy with at most 15
/// primitives in a volume. Throws InputError if the scene can't be loaded.
VolumeTypes count_volume_types(const std::string& scene, int width_px, int height_px);

/// The page's section, and what the plot draws.
std::string ray_shares_text(const std::vector<RayShares>& shares);
std::string ray_shares_data(const std::vector<RayShares>& shares);

}  // namespace rayfarm
