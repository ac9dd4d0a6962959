#pragma once
// How much is left to see behind each limit of the lighting tree (thesis 2.3.4): pictures of mirrors, of
// glass and of both, with more and more reflections and transmissions, against deep ones.
#include "host/experiments/experiment_options.h"

namespace rayfarm {

/// Writes numbers, plots and a page. Returns the exit code.
int run_depth_experiment(const ExperimentOptions& options, const RunRender& render);

}  // namespace rayfarm
