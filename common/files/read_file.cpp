#include "common/files/read_file.h"

#include <unistd.h>

#include <algorithm>
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

void require_size(const std::string& path, uintmax_t size, uintmax_t most) {
  if (size > most)
    throw InputError({path},
                     fmt::format("the file is larger than {} MiB, the most that is read", most >> 20));
}

/// The text behind the mark of UTF-8, if it has one.
std::string_view checked_text(const std::string& path, std::string_view bytes) {
  if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
  refuse_wide_text(path, bytes);
  return bytes;
}

[[noreturn]] void fail_reading(const std::string& path) {
  throw IoError(fmt::format("{}: reading failed: {}", path, std::strerror(errno)));
}

/// Up to `size` bytes from `offset` on; returns how many there are. Throws IoError and Stopped.
size_t read_bytes(const std::string& path, const RegularFile& opened, size_t offset, size_t size, char* into,
                  const std::stop_token& stop) {
  constexpr size_t kPiece = 4 << 20;
  size_t done = 0;
  while (done < size) {
    throw_if_stopped(stop);
    const ssize_t n = pread(fileno(opened.file.get()), into + done, std::min(kPiece, size - done),
                            static_cast<off_t>(offset + done));
    if (n < 0 && errno != EINTR) fail_reading(path);
    if (n == 0) break;
    if (n > 0) done += static_cast<size_t>(n);
  }
  return done;
}

}  // namespace

std::string read_file(const std::string& path, uintmax_t max_bytes, const std::stop_token& stop) {
  const RegularFile opened = open_regular_file(path);
  require_size(path, opened.size_bytes, max_bytes);
  std::string text;
  text.reserve(opened.size_bytes);
  std::vector<char> chunk(1 << 20);
  while (const size_t read = std::fread(chunk.data(), 1, chunk.size(), opened.file.get())) {
    throw_if_stopped(stop);
    text.append(chunk.data(), read);
    require_size(path, text.size(), max_bytes);  // it may have grown
  }
  if (std::ferror(opened.file.get())) fail_reading(path);
  return text;
}

void refuse_wide_text(const std::string& path, std::string_view bytes) {
  if (const char* encoding = wide_encoding(bytes))
    throw InputError({path},
                     fmt::format("the file is in {0}; save it as UTF-8 (`iconv -f {0} -t UTF-8`)", encoding));
}

std::string read_text_file(const std::string& path, uintmax_t max_bytes, const std::stop_token& stop) {
  std::string text = read_file(path, max_bytes, stop);
  text.erase(0, text.size() - checked_text(path, text).size());
  return text;
}

FileText read_large_file(const std::string& path, uintmax_t max_bytes, const std::stop_token& stop) {
  FileText result;
  result.path_ = path;
  result.opened_ = open_regular_file(path);
  const size_t size = result.opened_.size_bytes;  // what it grows by meanwhile is left out
  require_size(path, size, max_bytes);
  result.bytes_.reset(static_cast<char*>(allocate_large(size)));
  const size_t read = read_bytes(path, result.opened_, 0, size, result.bytes_.get(), stop);
  result.text_ = {result.bytes_.get(), read};
  return result;
}

FileText read_large_text_file(const std::string& path, uintmax_t max_bytes, const std::stop_token& stop) {
  FileText result = read_large_file(path, max_bytes, stop);
  result.text_ = checked_text(path, result.text_);
  return result;
}

void FileText::read_again(std::string_view part) {
  read_bytes(path_, opened_, static_cast<size_t>(part.data() - bytes_.get()), part.size(), place_of(part),
             {});
}

}  // namespace rayfarm
