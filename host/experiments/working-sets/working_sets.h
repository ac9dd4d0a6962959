#pragma once
// Active memory while tracing (Table 4.12): which pages of the scene's block are touched in an interval.
#include "host/experiments/experiment_options.h"

namespace rayfarm {

/// Prints a table and writes a page. Returns an exit code.
int run_working_set_experiment(const ExperimentOptions& options);

}  // namespace rayfarm
