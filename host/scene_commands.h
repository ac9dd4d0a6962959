#pragma once
// The commands that need no farm. Results go to stdout, problems are thrown.
#include "host/command_line.h"

namespace rayfarm {

/// Validates a scene and lists every file it uses.
int run_check(const std::string& path);
/// Prints counts, bounds, object tree and memory.
int run_info(const std::string& path);
/// Compares two images; 0 if they agree within the tolerance, else 1.
int run_compare(const CompareOptions& options);

}  // namespace rayfarm
