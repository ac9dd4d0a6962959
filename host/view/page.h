#pragma once
#include <string>

namespace rayfarm {

/// page.html, which the build puts into the executable.
extern const std::string kViewPage;

}  // namespace rayfarm
