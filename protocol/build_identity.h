#pragma once
#include <string>

namespace rayfarm {

/// Identifies this executable: the linker's build id (GNU note) in hexadecimal. Host and nodes of different
/// builds must not work together, for their images might differ.
std::string build_identity();

/// This machine's name.
std::string machine_name();

/// Ends a hung process of this job on this machine. A process that runs another program has only inherited
/// the number: it is left alone.
void end_hung_process(unsigned pid);

}  // namespace rayfarm
