#include "common/scene/settings_codec.h"

#include <cereal/archives/portable_binary.hpp>
#include <sstream>

namespace rayfarm {

std::vector<std::byte> encode_settings(const RenderSettings& settings) {
  std::ostringstream out;
  {
    cereal::PortableBinaryOutputArchive archive(out);
    archive(settings);
  }
  const std::string text = out.str();
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

RenderSettings decode_settings(std::span<const std::byte> bytes) {
  std::istringstream in(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  cereal::PortableBinaryInputArchive archive(in);
  RenderSettings settings;
  archive(settings);
  return settings;
}

}  // namespace rayfarm
