#include "common/files/read_file.h"

#include <cerrno>
#include <cstring>
#include <string_view>
#include <vector>

#include "common/errors/input_error.h"
#include "common/files/regular_file.h"

namespace rayfarm {
namespace {

/// The name of the encoding whose mark the text begins with, or whose zeros stand about its first letter;
/// null if a letter is a byte.
const char* wide_encoding(std::string_view text) {
  using namespace std::string_view_literals;
  const std::string_view begin = text.substr(0, 4);
  const auto zeros = [begin](std::string_view pattern) {  // '0': a zero, 'x': none
    for (size_t i = 0; i < pattern.size(); ++i)
      if (i >= begin.size() || (begin[i] == 0) != (pattern[i] == '0')) return false;
    return true;
  };
  if (begin == "\xff\xfe\0\0"sv || begin == "\0\0\xfe\xff"sv || zeros("x000") || zeros("000x"))
    return "UTF-32";
  if (begin.starts_with("\xff\xfe"sv) || begin.starts_with("\xfe\xff"sv) || zeros("x0") || zeros("0x"))
    return "UTF-16";
  return nullptr;
}

}  // namespace

std::string read_file(const std::string& path, uintmax_t max_bytes, const std::stop_token& stop) {
  const RegularFile opened = open_regular_file(path);
  const auto require_size = [&](uintmax_t size) {
    if (size > max_bytes)
      throw InputError({path},
                       fmt::format("the file is larger than {} MiB, the most that is read", max_bytes >> 20));
  };
  require_size(opened.size_bytes);
  std::string text;
  text.reserve(opened.size_bytes);
  std::vector<char> chunk(1 << 20);
  while (const size_t read = std::fread(chunk.data(), 1, chunk.size(), opened.file.get())) {
    throw_if_stopped(stop);
    text.append(chunk.data(), read);
    require_size(text.size());  // it may have grown
  }
  if (std::ferror(opened.file.get()))
    throw IoError(fmt::format("{}: reading failed: {}", path, std::strerror(errno)));
  return text;
}

std::string read_text_file(const std::string& path, uintmax_t max_bytes, const std::stop_token& stop) {
  std::string text = read_file(path, max_bytes, stop);
  if (text.starts_with("\xef\xbb\xbf")) text.erase(0, 3);
  if (const char* encoding = wide_encoding(text))
    throw InputError({path},
                     fmt::format("the file is in {0}; save it as UTF-8 (`iconv -f {0} -t UTF-8`)", encoding));
  return text;
}

}  // namespace rayfarm
