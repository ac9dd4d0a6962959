#pragma once
// The thesis's claim about the net (section 4.4.4.2), measured: real renders on a virtual cluster whose net
// is as slow as its processors are, beside the model and the simulation.
#include "host/experiments/experiment_options.h"

namespace rayfarm {

/// `render` runs one job in this process. Needs root. Returns the first exit code that is not 0.
int run_net_load_experiment(const ExperimentOptions& options, const RunRender& render);

}  // namespace rayfarm
