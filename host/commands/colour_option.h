#pragma once
// --colour: what colours are computed as.
#include "common/scene/render_settings.h"
#include "host/commands/command_line.h"

namespace rayfarm {

void add_colour_option(Options& options, RenderSettings& settings);

}  // namespace rayfarm
