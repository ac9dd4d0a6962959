#pragma once
// The pictures of the thesis's chapter 3 again: renders them, counts rays, and writes a page that sets what
// came out beside the thesis's words.
#include "host/experiments/experiment_options.h"

namespace rayfarm {

/// `render` runs one job in this process. Returns the first exit code that is not 0.
int run_lighting_experiment(const ExperimentOptions& options, const RunRender& render);

}  // namespace rayfarm
