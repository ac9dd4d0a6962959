#pragma once
#include <filesystem>
#include <fstream>
#include <string>

namespace rayfarm::fuzz {

/// In which files are written to be read.
struct Folder {
  std::string path;
  std::string write(const std::string& name, const std::string& bytes) const {
    const std::string file = (std::filesystem::path(path) / name).string();
    std::ofstream(file, std::ios::binary) << bytes;
    return file;
  }
};

}  // namespace rayfarm::fuzz
