#pragma once
// What zones give and cost (zones: the thesis's 2.2.5; Shirley, Sung and Brown 1991, sections 3 and 4):
// errors against paths, time and rays, rounds, ranks, the full matrix, directional zones and media, set
// beside what is asked of each.
#include "host/experiments/experiment_options.h"

namespace rayfarm {

/// Writes numbers, plots and a page. `render` runs one job in this process. Returns the exit code.
int run_zones_experiment(const ExperimentOptions& options, const RunRender& render);

}  // namespace rayfarm
