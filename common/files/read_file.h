#pragma once
// Whole files, as text or as bytes.
#include <memory>
#include <string>
#include <string_view>

#include "common/errors/stop.h"
#include "common/files/regular_file.h"
#include "common/memory/large_vector.h"

namespace rayfarm {

/// All bytes of the file; throws IoError if it can't be read and InputError if it is larger than `max_bytes`.
std::string read_file(const std::string& path, uintmax_t max_bytes, const std::stop_token& stop = {});
/// The same of a file of text. A mark of UTF-8 at its beginning is left out; UTF-16 and UTF-32 are refused.
std::string read_text_file(const std::string& path, uintmax_t max_bytes, const std::stop_token& stop = {});
/// Of bytes that may be text: throws InputError if they begin as UTF-16 or UTF-32 do.
void refuse_wide_text(const std::string& path, std::string_view bytes);

/// The text, or the bytes, of a large file.
class FileText {
 public:
  std::string_view text() const { return text_; }

  /// Gives the memory of a part of the text back: until it is read again its bytes are lost. Any thread, as
  /// long as parts are apart.
  void give_back(std::string_view part) { release_pages(place_of(part), part.size()); }
  /// Reads such a part again; what the file holds less by now is zeros. Throws IoError.
  void read_again(std::string_view part);

 private:
  friend FileText read_large_file(const std::string&, uintmax_t, const std::stop_token&);
  friend FileText read_large_text_file(const std::string&, uintmax_t, const std::stop_token&);
  char* place_of(std::string_view part) { return bytes_.get() + (part.data() - bytes_.get()); }
  struct Free {
    void operator()(char* bytes) const { free_large(bytes); }
  };
  std::string path_;
  RegularFile opened_;
  std::unique_ptr<char, Free> bytes_;
  std::string_view text_;
};
/// As read_file. The file is read and not mapped: what becomes of it meanwhile ends in an error at worst.
FileText read_large_file(const std::string& path, uintmax_t max_bytes, const std::stop_token& stop = {});
/// The same of a file of text, as read_text_file.
FileText read_large_text_file(const std::string& path, uintmax_t max_bytes, const std::stop_token& stop = {});

}  // namespace rayfarm
