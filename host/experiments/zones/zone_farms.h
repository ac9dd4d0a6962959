#pragma once
// Zones on farms of several nodes: the same to the byte, and in the time that the model tells.
#include "host/experiments/zones/zone_runs.h"

namespace rayfarm {

/// Throws RenderFailed.
ZoneStudy study_zone_farms(const ZoneWork& work, const RunRender& render);

}  // namespace rayfarm
