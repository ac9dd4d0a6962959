#include "host/text_file.h"

#include <filesystem>
#include <fstream>

#include "common/scene/input_error.h"

namespace rayfarm {

void write_text_file(const std::string& path, const std::string& text) {
  const std::string temporary = path + ".part";
  std::ofstream file(temporary, std::ios::trunc);
  file << text;
  file.close();
  std::error_code error;
  if (file) std::filesystem::rename(temporary, path, error);
  if (file && !error) return;
  std::error_code ignored;
  std::filesystem::remove(temporary, ignored);
  throw IoError(fmt::format("{}: can't be written; check the folder and the space left", path));
}

}  // namespace rayfarm
