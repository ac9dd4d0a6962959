#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "common/scene/scene_loaders.h"

namespace rayfarm {

std::string read_text_file(const std::string& path, uintmax_t max_bytes) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status))
    throw IoError(fmt::format("{}: no such file; check the path (it is relative to {})", path,
                              std::filesystem::current_path(error).string()));
  if (std::filesystem::is_directory(status))
    throw IoError(fmt::format("{}: is a folder; a file is needed", path));
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in) throw IoError(fmt::format("{}: can't be opened: {}", path, std::strerror(errno)));
  std::string text;
  std::vector<char> chunk(1 << 20);
  while (in.read(chunk.data(), static_cast<std::streamsize>(chunk.size())) || in.gcount() > 0) {
    text.append(chunk.data(), static_cast<size_t>(in.gcount()));
    if (text.size() > max_bytes)
      throw InputError({path},
                       fmt::format("the file is larger than {} MiB, the most that is read", max_bytes >> 20));
  }
  if (in.bad()) throw IoError(fmt::format("{}: reading failed: {}", path, std::strerror(errno)));
  return text;
}

SceneDescription load_scene(const std::string& path, const std::stop_token& stop) {
  const std::string extension = std::filesystem::path(path).extension().string();
  SceneDescription scene;
  if (extension == ".yaml" || extension == ".yml")
    scene = load_yaml_scene(path);
  else if (extension == ".nff")
    scene = load_nff_scene(path);
  else
    throw IoError(
        fmt::format("{}: unknown scene format '{}'; Rayfarm reads .yaml and .nff (an .obj mesh goes into a "
                    ".yaml scene: `- mesh: {{file: {}}}`)",
                    path, extension, std::filesystem::path(path).filename().string()));
  throw_if_stopped(stop);
  validate(scene);
  return scene;
}

}  // namespace rayfarm
