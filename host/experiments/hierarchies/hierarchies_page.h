#pragma once
// The page of the hierarchies.
#include <string>
#include <vector>

#include "host/experiments/hierarchies/hierarchy_runs.h"
#include "host/instrument/table.h"

namespace rayfarm {

/// A hierarchy with its setting on one image.
struct HierarchyRow {
  int image = 1;          ///< of the thesis, from 1
  std::string hierarchy;  ///< as on the command line
  std::string setting;    ///< its cut or cells
  HierarchyRun run;
};

/// N_V of all rays: cells, or nodes and leaves.
double volumes_per_ray(const HierarchyRun& run);
double primitives_per_ray(const HierarchyRun& run);

Table hierarchies_table(const std::vector<HierarchyRow>& rows);
std::string hierarchies_page(const std::vector<HierarchyRow>& rows, int side_px);

}  // namespace rayfarm
