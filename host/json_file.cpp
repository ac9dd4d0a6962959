#include "host/json_file.h"

#include "common/description/formats/scene_loaders.h"
#include "common/files/read_file.h"

namespace rayfarm {

nlohmann::json read_json_file(const std::string& path) {
  return nlohmann::json::parse(read_text_file(path, limits::kFileBytes));
}

}  // namespace rayfarm
