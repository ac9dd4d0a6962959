#pragma once
// Options of a render that exclude each other.
#include "host/render/render_options.h"

namespace rayfarm {

/// Throws UsageError, which says which options do not go together, and why.
void check_combinations(const RenderOptions& options);

}  // namespace rayfarm
