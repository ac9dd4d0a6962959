#pragma once
// Files of text that appear under their names only when they are whole.
#include <string>

namespace rayfarm {

/// Writes beside `path`, then renames. Throws IoError; nothing is left behind then.
void write_text_file(const std::string& path, const std::string& text);

}  // namespace rayfarm
