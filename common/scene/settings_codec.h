#pragma once
#include <span>
#include <stdexcept>
#include <vector>

#include "common/scene/render_settings.h"

namespace rayfarm {

/// No renderer can work with these settings, or these bytes are none.
class SettingsError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws SettingsError.
void check_settings(const RenderSettings& settings);

/// The settings as bytes that any machine reads back (cereal, portable binary).
std::vector<std::byte> encode_settings(const RenderSettings& settings);
/// Throws SettingsError if the bytes are not settings, or such that check_settings refuses.
RenderSettings decode_settings(std::span<const std::byte> bytes);

}  // namespace rayfarm
