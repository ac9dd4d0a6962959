#pragma once
// How zones are cut and solved, and how pictures show them: the --zone options.
#include "host/commands/command_line.h"
#include "host/render/render_options.h"

namespace rayfarm {

void add_zone_options(Options& options, RenderOptions& o);
/// Those of them that say how many zones there may be.
void add_zone_size_options(Options& options, ZoneSettings& zones);
void add_zone_view_option(Options& options, RenderOptions& o);

}  // namespace rayfarm
