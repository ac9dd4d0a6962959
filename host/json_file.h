#pragma once
// JSON files that Rayfarm wrote.
#include <nlohmann/json.hpp>
#include <string>

namespace rayfarm {

/// Throws IoError if the file can't be read, nlohmann::json::exception if it is not JSON.
nlohmann::json read_json_file(const std::string& path);

}  // namespace rayfarm
