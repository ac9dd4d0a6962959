#pragma once
// The page of the zones experiment.
#include "host/experiments/zones/zone_runs.h"

namespace rayfarm {

/// Numbers, plots and README.md.
void write_zones_page(const ZoneWork& work, const std::vector<ZoneStudy>& studies);

}  // namespace rayfarm
