#pragma once
// Options of all commands that need a farm.
#include "host/commands/command_line.h"
#include "host/render/render_options.h"

namespace rayfarm {

/// How far light is followed.
void add_depth_options(Options& options, RenderOptions& o);
void add_self_hit_option(Options& options, RenderOptions& o);
void add_assign_option(Options& options, RenderOptions& o);
/// How many nodes, and when they are lost.
void add_node_options(Options& options, RenderOptions& o);
void add_progress_option(Options& options, RenderOptions& o);
void add_quiet_options(Options& options, RenderOptions& o);

/// A limit that was not given follows from those that were: a depth alone leaves all kinds of rays to it, and
/// limits of the kinds have the depth that they need. Throws UsageError.
void set_limits(RenderOptions& o);

}  // namespace rayfarm
