#pragma once
// How light that is still to be sent dies away, and what the ways to solve the equations of zones cost: the
// full matrix (the thesis's 2.2.5, Equation 2.6) and progressive refinement (Shirley, Sung and Brown 1991,
// section 3).
#include "host/experiments/zones/zone_runs.h"

namespace rayfarm {

/// All zones at a time, and the fullest at a time.
ZoneStudy study_rounds(const ZoneWork& work);

/// Do all ways lead to the same light? And form factors of unit squares.
ZoneStudy study_matrix(const ZoneWork& work);

}  // namespace rayfarm
