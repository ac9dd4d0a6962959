#pragma once
// Pictures with fewer pixels than subpolygons asked for.
#include <string>

#include "protocol/subpolygons.h"

namespace rayfarm {

/// Says what is missing where a picture has no room for `per_processor` subpolygons of `least_side` pixels
/// for each processor, and why; empty if it has.
std::string tell_missing_subpolygons(const SubpolygonGrid& grid, int processors, int per_processor,
                                     int least_side);

}  // namespace rayfarm
