#pragma once
#include <functional>
#include <string>
#include <vector>

namespace rayfarm::fuzz {

struct Target {
  std::string name;
  /// Reads the bytes and uses what it read. Throws InputError, IoError, ProtocolError, SceneBlockError,
  /// SettingsError or std::domain_error for what is wrong with them; anything else is a finding.
  std::function<void(const std::string& bytes)> run;
  std::vector<std::string> seeds;
  std::vector<std::string> words;  ///< of the format
  bool keeps_size = false;         ///< else nothing but the size would ever be found wrong
};

/// `folder`: for files that are read.
std::vector<Target> make_targets(const std::string& folder);

}  // namespace rayfarm::fuzz
