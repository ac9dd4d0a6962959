#pragma once
// Balance without a net: eight emulated processors in this process, beside the simulation.
#include <string>
#include <vector>

#include "host/experiments/net-load/local_runs.h"
#include "host/experiments/net-load/net_load_page.h"

namespace rayfarm {

/// `even_scene`: the file of a scene that costs much the same all over.
std::vector<BalanceRun> measure_balance(const LocalRuns& runs, const std::string& even_scene, int width_px);

}  // namespace rayfarm
