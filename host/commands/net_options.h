#pragma once
// Options that the commands about the net have in common.
#include "host/commands/command_line.h"
#include "host/instrument/table.h"
#include "protocol/subpolygons.h"

namespace rayfarm {

/// `8mbit`, `10gbit`, `64kbit`, `9600bit`: bits per second.
void add_rate(Options& options, double& rate_bit_per_s);
/// How interleaved sets lie.
void add_sets(Options& options, SetPattern& sets);
void add_format(Options& options, TableFormat& format);

}  // namespace rayfarm
