#pragma once
// How far pictures of zones are from those of `path`, over the size of zones and over rays (Shirley, Sung and
// Brown 1991, section 3).
#include "host/experiments/zones/zone_runs.h"

namespace rayfarm {

ZoneStudy study_zone_errors(const ZoneWork& work);

}  // namespace rayfarm
