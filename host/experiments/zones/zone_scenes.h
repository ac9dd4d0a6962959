#pragma once
// Directional zones, media, and scenes whose light is known without a picture.
#include "host/experiments/zones/zone_runs.h"

namespace rayfarm {

/// Figures 4 and 8 of Shirley, Sung and Brown 1991: imperfect floors, a gallery with a medium.
ZoneStudy study_zone_figures(const ZoneWork& work);

/// Furnaces, a cube with a zone on each face, slabs.
ZoneStudy study_known_light(const ZoneWork& work);

}  // namespace rayfarm
