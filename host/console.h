#pragma once
// Text for people, on stderr. A stderr that is full or closed loses text, never a picture.
#include <fmt/core.h>

#include <cstdio>
#include <string>
#include <utility>

namespace rayfarm {

template <typename... Args>
void say(fmt::format_string<Args...> format, Args&&... args) {
  const std::string text = fmt::format(format, std::forward<Args>(args)...);
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

}  // namespace rayfarm
