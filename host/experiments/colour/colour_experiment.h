#pragma once
// What colours cost and gain as RGB and as spectra at 4, 20 or any wavelengths (Shirley, Sung and Brown 1991,
// section 2.1): time, and the difference that is seen from spectra at 200.
#include "host/experiments/experiment_options.h"

namespace rayfarm {

/// `render` runs one job in this process. Returns the first exit code that is not 0.
int run_colour_experiment(const ExperimentOptions& options, const RunRender& render);

}  // namespace rayfarm
