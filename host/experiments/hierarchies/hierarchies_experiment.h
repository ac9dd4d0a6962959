#pragma once
// What arranging a scene's primitives costs and saves (thesis, chapter 4).
#include "host/experiments/experiment_options.h"

namespace rayfarm {

/// Measures every hierarchy on the thesis's three images and writes the page into the options' folder.
/// Returns the exit code.
int run_hierarchies_experiment(const ExperimentOptions& options);

}  // namespace rayfarm
