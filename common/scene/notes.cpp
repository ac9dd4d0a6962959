#include "common/scene/notes.h"

#include <algorithm>

namespace rayfarm {

void Notes::add(const SourcePlace& place, std::string_view text) {
  std::string line = fmt::format("{}: {}", to_string(place), text);
  if (std::find(lines_.begin(), lines_.end(), line) == lines_.end()) lines_.push_back(std::move(line));
}

void Notes::add(const Notes& others) {
  lines_.insert(lines_.end(), others.lines_.begin(), others.lines_.end());
}

}  // namespace rayfarm
