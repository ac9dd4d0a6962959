#pragma once
// Reading images of many formats with OpenImageIO. It stands in a module of its own, loaded by the process
// that first reads an image: OpenImageIO and the libraries behind it take 31 MB and a third of a second to
// start, and a node, which opens no file, needs none of them.
#include <string>
#include <vector>

namespace rayfarm {

/// An image as its file holds it, in whatever encoding.
struct ReadImage {
  int width_px = 0, height_px = 0;
  std::vector<float> pixels;  ///< height × width × 3, row-major, origin top left
};

/// Reads the first three channels of any image. Returns what went wrong, or nothing.
using ReadImageFunction = std::string(const std::string& path, ReadImage& image);

/// The module's one symbol, a ReadImageFunction.
inline constexpr const char* kReadImageSymbol = "rayfarm_read_image";

}  // namespace rayfarm
