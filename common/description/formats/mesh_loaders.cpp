#include "common/description/formats/mesh_loaders.h"

#include <algorithm>

#include "common/image/image_file.h"

namespace rayfarm {

const MeshFormat* find_mesh_format(const std::string& path) {
  const std::string extension = extension_of(path);
  const auto found = std::find_if(std::begin(kMeshFormats), std::end(kMeshFormats),
                                  [&](const MeshFormat& f) { return extension == f.extension; });
  return found == std::end(kMeshFormats) ? nullptr : found;
}

std::string mesh_extensions() {
  std::string words;
  for (const MeshFormat& format : kMeshFormats) {
    const bool is_last = &format == std::end(kMeshFormats) - 1;
    if (!words.empty()) words += is_last ? " or " : ", ";
    words += format.extension;
  }
  return words;
}

}  // namespace rayfarm
