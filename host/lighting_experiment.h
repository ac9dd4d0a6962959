#pragma once
// The pictures of the thesis's chapter 3 again: renders them, counts rays, and writes a page that sets what
// came out beside the thesis's words.
#include <functional>

#include "host/command_line.h"

namespace rayfarm {

/// `render` runs one job and returns its exit code. Returns the first that is not 0.
int run_lighting_experiment(const ExperimentOptions& options,
                            const std::function<int(const RenderOptions&)>& render);

}  // namespace rayfarm
