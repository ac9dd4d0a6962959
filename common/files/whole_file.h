#pragma once
// Files that appear under their names only when they are whole: written beside, forced to the disk, renamed.
// A file in the making is `.NAME.HOST.PROCESS.RANDOM.part`; it is created exclusively, so that no link that
// somebody left there is followed.
#include <cstdio>
#include <functional>
#include <string>

namespace rayfarm {

/// Lets `write` fill a new file, open for writing and reading, that then takes the place of `path`. Files in
/// the making of the same name whose processes died on this machine are removed. Throws IoError with what
/// went wrong, what `write` threw included; nothing is left behind then.
void write_whole_file(const std::string& path, const std::function<void(std::FILE* file)>& write);

}  // namespace rayfarm
