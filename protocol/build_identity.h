#pragma once
#include <string>

namespace rayfarm {

/// Identifies this executable: the linker's build id (GNU note) in hexadecimal. Host and nodes of different
/// builds must not work together, for their images might differ.
std::string build_identity();

/// This machine's name.
std::string machine_name();

}  // namespace rayfarm
