#pragma once
// What zones cost against `path` at the same noise, for a picture and for a walk through a scene, and what
// the thesis's model costs beside Whitted's.
#include "host/experiments/zones/zone_runs.h"

namespace rayfarm {

/// Throws RenderFailed.
ZoneStudy study_zone_costs(const ZoneWork& work, const RunRender& render);

}  // namespace rayfarm
