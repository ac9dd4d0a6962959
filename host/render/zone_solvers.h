#pragma once
// Who finds the light of zones.
#include <functional>
#include <memory>

#include "common/lighting/zones/zone_solver.h"

namespace rayfarm {

using MakeZoneSolver =
    std::function<std::unique_ptr<ZoneSolver>(const Scene& scene, const RenderSettings& settings, int frame)>;

/// Of the settings' lighting model; empty if that has no zones. Stands alone in its file, so that a test may
/// be linked with another.
MakeZoneSolver zone_solvers_of(const RenderSettings& settings);

}  // namespace rayfarm
