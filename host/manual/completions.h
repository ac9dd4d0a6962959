#pragma once
// What shells complete behind `rayfarm`: commands, options, the words that an option takes, and files.
#include "host/commands/outline.h"

namespace rayfarm {

std::string bash_completion_of(const ProgramOutline& program);
std::string zsh_completion_of(const ProgramOutline& program);
std::string fish_completion_of(const ProgramOutline& program);

}  // namespace rayfarm
