#pragma once
// The page of the bounding volumes: Tables II to IX of Weghorst, Hooper and Greenberg beside ours.
#include <string>
#include <vector>

#include "host/experiments/bounding-volumes/bounding_runs.h"
#include "host/experiments/bounding-volumes/volume_factors.h"
#include "host/instrument/table.h"

namespace rayfarm {

/// All that was measured.
struct BoundingResults {
  int width_px = 0, height_px = 0;
  std::vector<EnvironmentRun> environments;  ///< in the order of weghorst::kEnvironments
  std::array<VolumeFactor, kVolumeKinds> factors;
  ViewCost front, side;  ///< of the wheel
};

Table bounding_table(const BoundingResults& results);
std::string bounding_page(const BoundingResults& results);

}  // namespace rayfarm
