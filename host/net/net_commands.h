#pragma once
// `rayfarm model` and `rayfarm simulate`: the thesis's net as an equation and as a simulation.
#include "host/command_line.h"

namespace CLI {
class App;
}

namespace rayfarm {

void add_model_command(CLI::App& app, CommandLine& line);
void add_simulate_command(CLI::App& app, CommandLine& line);

/// Print tables on stdout.
int run_model(const ModelOptions& options);
int run_simulate(const SimulateOptions& options);

}  // namespace rayfarm
