#pragma once
// Files that appear under their names only when they are whole: written beside, forced to the disk, renamed.
// A file in the making is `.NAME.HOST.PROCESS.RANDOM.part`; it is created exclusively, so that no link that
// somebody left there is followed.
#include <functional>
#include <span>
#include <string>

#include "common/files/regular_file.h"

namespace rayfarm {

/// A file in the making, for one thread at a time. After something was thrown nothing of it is left.
class WholeFile {
 public:
  /// Files in the making of the same name whose processes died on this machine are removed. Throws IoError.
  explicit WholeFile(const std::string& path);
  /// Removes what was not committed.
  ~WholeFile();
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  /// Lets `work` write and read. What it throws, or a full disk that is behind it, becomes an IoError.
  void write(const std::function<void(std::FILE* file)>& work);
  /// Forces the file to its disk, and lets it take the place of `path`: the last that is done with it. Throws
  /// IoError.
  void commit();

 private:
  /// Removes the file and throws.
  [[noreturn]] void fail(const std::string& problem);
  void remove();

  std::string path_;
  std::string temporary_;  ///< empty: none is there
  OpenFile file_;
};

/// Lets `write` fill a new file, open for writing and reading, that then takes the place of `path`. Throws
/// IoError with what went wrong, what `write` threw included; nothing is left behind then.
void write_whole_file(const std::string& path, const std::function<void(std::FILE* file)>& write);

/// Removes files in the making of these names whose processes on this machine have ended. Each folder is
/// looked through once.
void remove_stale_files(std::span<const std::string> paths);
/// Removes files in the making of this name that processes of other machines made: to be called where it is
/// known that none of these writes it any more.
void remove_files_of_other_machines(const std::string& path);

}  // namespace rayfarm
