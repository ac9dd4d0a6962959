#pragma once
// How zones are cut, solved and shown: the --zone options.
#include "common/scene/zone_settings.h"
#include "host/commands/command_line.h"

namespace rayfarm {

void add_zone_options(Options& options, ZoneSettings& zones);

}  // namespace rayfarm
