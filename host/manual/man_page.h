#pragma once
// Manual pages in the man macros of roff(7), which man-db and mandoc both read.
#include "host/commands/outline.h"

namespace rayfarm {

/// Page rayfarm(1).
std::string man_page_of(const ProgramOutline& program);
/// Page rayfarm-COMMAND(1).
std::string man_page_of(const ProgramOutline& program, const CommandOutline& command);

}  // namespace rayfarm
