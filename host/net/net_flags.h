#pragma once
// Flags that commands about the net have in common.
#include <CLI/CLI.hpp>
#include <string>

#include "host/net/net_options.h"

namespace rayfarm {

/// `8mbit`, `10gbit`, `64kbit`, `9600bit`: bits per second. Throws CLI::ValidationError.
double parse_rate(const std::string& text);

void add_rate(CLI::App* app, double& rate_bit_per_s);
void add_format(CLI::App* app, TableFormat& format);

}  // namespace rayfarm
