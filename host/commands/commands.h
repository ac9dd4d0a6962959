#pragma once
// All commands; each has a file of its own.
#include "host/commands/command_line.h"

namespace rayfarm {

void add_render_command(CommandLine& line);
void add_bake_command(CommandLine& line);
void add_check_command(CommandLine& line);
void add_info_command(CommandLine& line);
void add_compile_command(CommandLine& line);
void add_convert_command(CommandLine& line);
void add_compare_command(CommandLine& line);
void add_experiment_command(CommandLine& line);
void add_model_command(CommandLine& line);
void add_simulate_command(CommandLine& line);

/// Reads what the user typed.
Request read_command_line(int argc, char** argv);
/// All that may be typed.
ProgramOutline outline_of_commands();

}  // namespace rayfarm
