#pragma once
// What is said once about a scene that can be rendered all the same: input that is not used, a light that
// can't shine, what is left out. Loaders and the compiler fill it; every command that reads a scene prints
// it.
#include <string_view>
#include <unordered_set>
#include <vector>

#include "common/errors/input_error.h"

namespace rayfarm {

class Notes {
 public:
  /// The line reads `file:line:column: text`, the text being the problem, why, and what to do. The same line
  /// is kept once.
  void add(const SourcePlace& place, std::string_view text);
  void add(const Notes& others);
  const std::vector<std::string>& lines() const { return lines_; }

 private:
  std::vector<std::string> lines_;
  std::unordered_set<std::string> known_;
};

}  // namespace rayfarm
