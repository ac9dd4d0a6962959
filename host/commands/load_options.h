#pragma once
// What scenes are read for: --clip, --fps and --camera.
#include "common/description/load_options.h"
#include "host/commands/command_line.h"

namespace rayfarm {

void add_load_options(Options& options, LoadOptions& load);

}  // namespace rayfarm
