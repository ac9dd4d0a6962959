#pragma once
// Text for people, on stderr. A stderr that is full or closed loses text, never a picture.
#include <fmt/core.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <utility>

namespace rayfarm {

template <typename... Args>
void say(fmt::format_string<Args...> format, Args&&... args) {
  const std::string text = fmt::format(format, std::forward<Args>(args)...);
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

/// False, and said, if what was printed on stdout did not arrive.
inline bool flush_results() {
  if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return true;
  say("rayfarm: what belongs there can't be printed on stdout: {}\n", std::strerror(errno));
  std::clearerr(stdout);
  return false;
}

}  // namespace rayfarm
