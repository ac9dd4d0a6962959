#pragma once
// What --help prints: options by groups, wrapped to the width of the terminal.
#include "host/commands/outline.h"

namespace rayfarm {

/// Columns for text on stdout: the terminal's, from 60 to 110; 100 where it is none.
size_t help_width();

std::string help_of(const ProgramOutline& program, size_t width);
std::string help_of(const ProgramOutline& program, const CommandOutline& command, size_t width);

/// How a command is called: `rayfarm compile [OPTIONS] -o FILE SCENE`.
std::string usage_of(const ProgramOutline& program, const CommandOutline& command);

}  // namespace rayfarm
