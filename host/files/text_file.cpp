#include "host/files/text_file.h"

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "common/files/whole_file.h"

namespace rayfarm {

void write_text_file(const std::string& path, const std::string& text) {
  write_whole_file(path, [&text](std::FILE* file) {
    if (std::fwrite(text.data(), 1, text.size(), file) != text.size())
      throw std::runtime_error(std::strerror(errno));
  });
}

}  // namespace rayfarm
