#pragma once
// How zones are cut and solved, and how pictures show them: the --zone options.
#include "host/commands/command_line.h"
#include "host/render/render_options.h"

namespace rayfarm {

void add_zone_options(Options& options, RenderOptions& o);
void add_zone_view_option(Options& options, RenderOptions& o);

}  // namespace rayfarm
