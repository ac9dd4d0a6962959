#pragma once
// --build: what a build may take for the sake of the rays.
#include "common/hierarchy/builder.h"
#include "host/commands/command_line.h"

namespace rayfarm {

void add_build_option(Options& options, BuildQuality& quality);

}  // namespace rayfarm
