#pragma once
#include <string>
#include <vector>

namespace rayfarm::fuzz {

/// Data of stages, results of items, solutions and files of zones, of both models. The first byte tells
/// which.
std::vector<std::string> zone_seeds(const std::string& folder);

/// Does with the bytes what nodes, host and pictures do. Throws ProtocolError in place of std::runtime_error.
void read_zones(const std::string& folder, const std::string& bytes);

}  // namespace rayfarm::fuzz
