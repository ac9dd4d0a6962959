#pragma once
// A mesh, for what is larger than the thesis could hold.
#include <string>

namespace rayfarm {

/// A hilly terrain of 2 · cells² triangles as `path` (.yaml), its mesh beside it (.obj). Throws IoError.
void write_terrain(const std::string& path, int cells);

}  // namespace rayfarm
