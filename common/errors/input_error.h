#pragma once
// What a user can get wrong in a file: one exception, which carries the place, the problem, why, and what to
// do.
#include <fmt/core.h>

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace rayfarm {

/// A place in an input file. Lines and columns count from 1; 0 means unknown.
struct SourcePlace {
  std::string file;
  int line = 0;
  int column = 0;
};

inline std::string to_string(const SourcePlace& p) {
  if (p.line <= 0) return p.file;
  if (p.column <= 0) return fmt::format("{}:{}", p.file, p.line);
  return fmt::format("{}:{}:{}", p.file, p.line, p.column);
}

/// The scene or an asset is wrong. The message reads `file:line:column: problem`.
class InputError : public std::runtime_error {
 public:
  InputError(const SourcePlace& place, std::string_view problem)
      : std::runtime_error(fmt::format("{}: {}", to_string(place), problem)) {}
  /// Several, a line each.
  explicit InputError(const std::string& lines) : std::runtime_error(lines) {}
};

/// A file could not be read or written.
class IoError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// `; did you mean 'x'?` for the candidate closest to `word`, or nothing if none is close.
std::string suggestion(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace rayfarm
