#pragma once
// Smooth shading while a mesh turns (thesis 2.3.5): how far the light of flat polygons, of Gouraud's and
// Phong's interpolation and of the centre normal jumps from frame to frame, and how its slope does along a
// line.
#include "host/experiments/experiment_options.h"

namespace rayfarm {

int run_smoothing_experiment(const ExperimentOptions& options);

}  // namespace rayfarm
