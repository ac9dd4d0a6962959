#pragma once
// What a pixel weighs on the net by the size of subpolygons: the pixel wire against the block wire, whose
// header counts the more the smaller the blocks are (thesis 4.4.4.2 asks for 64 subpolygons a processor).
#include <string>
#include <vector>

#include "host/experiments/net-load/local_runs.h"

namespace rayfarm {

/// Of renders whose subpolygons have this side.
struct SizeRun {
  int side_px = 1;
  // Bytes a pixel in results, and with the control messages beside them.
  double pixel_wire = 0, pixel_wire_all = 0;
  double block = 0, block_all = 0;
  double compressed = 0;
  double header() const { return (block - 3) * side_px * side_px; }  ///< bytes of a block's
};

std::vector<SizeRun> measure_sizes(const LocalRuns& runs, const std::string& scene, int width_px);

/// The page's section.
std::string sizes_text(const std::vector<SizeRun>& sizes);

}  // namespace rayfarm
