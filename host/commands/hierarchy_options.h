#pragma once
// How hierarchies are built: --hierarchy and the options of each.
#include "common/hierarchy/builder.h"
#include "host/commands/command_line.h"

namespace rayfarm {

void add_hierarchy_options(Options& options, BuildOptions& build);

}  // namespace rayfarm
