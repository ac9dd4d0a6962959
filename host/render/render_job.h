#pragma once
#include "host/farm/farm.h"
#include "host/render/render_options.h"

namespace rayfarm {

/// Renders: loads and compiles the scene while the nodes report, sends code and data, runs the farm, reports.
/// Nodes are told to finish whatever happens.
Ending run_render(const RenderOptions& options, Farm& farm);

}  // namespace rayfarm
