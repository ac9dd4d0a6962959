#pragma once
// Whole files as text.
#include <string>

#include "common/errors/stop.h"

namespace rayfarm {

/// All bytes of the file; throws IoError if it can't be read and InputError if it is larger than `max_bytes`.
std::string read_file(const std::string& path, uintmax_t max_bytes, const std::stop_token& stop = {});
/// The same of a file of text. A mark of UTF-8 at its beginning is left out; UTF-16 and UTF-32 are refused.
std::string read_text_file(const std::string& path, uintmax_t max_bytes, const std::stop_token& stop = {});

}  // namespace rayfarm
