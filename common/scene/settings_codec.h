#pragma once
#include <span>
#include <vector>

#include "common/scene/render_settings.h"

namespace rayfarm {

/// The settings as bytes that any machine reads back (cereal, portable binary).
std::vector<std::byte> encode_settings(const RenderSettings& settings);
/// Throws std::runtime_error if the bytes are not settings.
RenderSettings decode_settings(std::span<const std::byte> bytes);

}  // namespace rayfarm
