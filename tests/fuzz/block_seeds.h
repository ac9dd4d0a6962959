#pragma once
#include <string>
#include <vector>

namespace rayfarm::fuzz {

/// The blocks of compiled scenes, with every hierarchy, and with structures in structures.
std::vector<std::string> block_seeds();

}  // namespace rayfarm::fuzz
