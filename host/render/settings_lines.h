#pragma once
// Settings as lines of text, for files that hold what was computed with them: so that whoever comes with
// others is told which differ.
#include <string>
#include <utility>
#include <vector>

#include "common/scene/render_settings.h"

namespace rayfarm {

/// By the options' names, and under `settings` a hash of all, those included that have no line.
std::vector<std::pair<std::string, std::string>> lines_of(const RenderSettings& settings);

/// What differs, for people, if a line of that name does: "another --seed".
std::string name_difference(const std::string& line);

}  // namespace rayfarm
