#pragma once
// PNG files of sRGB, 8 bits a channel.
#include <cstddef>
#include <map>
#include <span>
#include <string>

namespace rayfarm {

/// Writes height × width × 3 bytes, row-major, origin top left, with a text chunk for each attribute, and
/// reads them back to compare. Throws std::runtime_error with what went wrong.
void write_png(const std::string& path, int width_px, int height_px, std::span<const std::byte> rgb,
               const std::map<std::string, std::string>& attributes);

}  // namespace rayfarm
