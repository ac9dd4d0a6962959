#pragma once
// The options of `rayfarm render`.
#include "host/commands/command_line.h"
#include "host/render/render_options.h"

namespace rayfarm {

void add_render_options(Options& options, RenderOptions& o);

/// Throws UsageError where names of files can't be meant, whatever the scene asks for.
void check_output(const RenderOptions& o);

/// Settles what follows from the options. Throws UsageError where they don't fit together, or check_output
/// does.
void check_render(RenderOptions& o);

}  // namespace rayfarm
