#pragma once
// Image files: OpenEXR and PNG. A file appears under its name only when it is whole: written beside it, read
// back and compared, then renamed.
#include <map>
#include <string>
#include <vector>

#include "common/image/formats/image_formats.h"
#include "common/scene/render_settings.h"

namespace rayfarm {

/// A picture to write: the rendered rectangle of an image.
struct Image {
  int width_px = 0, height_px = 0;  ///< of the whole image (EXR: the display window)
  PixelRect window;                 ///< what `pixels` hold (EXR: the data window)
  PixelFormat format = PixelFormat::half_float;
  std::vector<std::byte> pixels;  ///< window height × width, row-major, origin top left
};

/// The file name's extension in small letters, with its dot.
std::string extension_of(const std::string& path);

/// True if `path` ends in an extension that can be written: .exr or .png.
bool is_writable_image(const std::string& path);
/// What a file of this name holds: PNG rgb8, EXR half.
PixelFormat natural_format(const std::string& path);

/// Writes by extension. EXR: bare R, G, B, A channels (alpha 1), half or float, ZIP, scene-linear Rec.709,
/// with the attributes given. PNG: sRGB, 8 bits. Throws IoError; nothing is left behind then.
void write_image(const std::string& path, const Image& image,
                 const std::map<std::string, std::string>& attributes);

/// Reads any image as linear-or-not floats, height × width × 3, as the file holds them. Throws IoError.
ReadImage read_image(const std::string& path);

/// SHA-256 of the bytes in hexadecimal.
std::string sha256(std::span<const std::byte> bytes);

}  // namespace rayfarm
