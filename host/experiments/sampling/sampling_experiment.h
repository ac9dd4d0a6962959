#pragma once
// How accurate each sampling pattern is (Shirley, Sung and Brown 1991, sections 2.2.1 and 4): the RMS error
// of pictures with 1 … 256 samples per pixel on six scenes, against pictures with many.
#include "host/experiments/experiment_options.h"

namespace rayfarm {

/// Writes numbers, plots and a page. Returns the exit code.
int run_sampling_experiment(const ExperimentOptions& options, const RunRender& render);

}  // namespace rayfarm
