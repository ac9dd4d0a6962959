#include "common/errors/notes.h"

namespace rayfarm {

void Notes::add(const SourcePlace& place, std::string_view text) {
  std::string line = fmt::format("{}: {}", to_string(place), text);
  if (known_.insert(line).second) lines_.push_back(std::move(line));
}

void Notes::add(const Notes& others) {
  for (const std::string& line : others.lines_)
    if (known_.insert(line).second) lines_.push_back(line);
}

}  // namespace rayfarm
