#pragma once
// What bounding volumes, clusters and an item buffer save (Weghorst, Hooper and Greenberg 1984).
#include "host/experiments/experiment_options.h"

namespace rayfarm {

/// Measures every combination on every environment and writes the page into the options' folder. Returns the
/// exit code.
int run_bounding_volumes_experiment(const ExperimentOptions& options);

}  // namespace rayfarm
