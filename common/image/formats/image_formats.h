#pragma once
// Reading images of many formats with OpenImageIO. It stands in a module of its own, loaded by the process
// that first reads an image: OpenImageIO and the libraries behind it take 31 MB and a third of a second to
// start, and a node, which opens no file, needs none of them.
#include <cstdint>
#include <memory>
#include <string>

namespace rayfarm {

/// An image opened for reading, its values as its file holds them, in whatever encoding.
class ImageSource {
 public:
  virtual ~ImageSource() = default;
  int width_px = 0, height_px = 0;
  bool has_alpha = false;
  int rows_at_once = 1;  ///< what `read_rows` wants, but for the last rows

  /// Reads `count` rows from `y` on: count × width × 3, row-major. Rows are read once each, from the top.
  /// Returns what went wrong, or nothing.
  virtual std::string read_rows(int y, int count, float* rgb) = 0;
};

/// What is read of an image: its first three channels, of a grey one thrice the first; or thrice its alpha.
/// Colours are not weighed by alpha, but where the format says that its file's are (EXR).
enum class ImagePart { color, alpha };

struct OpenedImage {
  std::unique_ptr<ImageSource> source;
  std::string problem;  ///< if there is no source
};

/// Opens what `descriptor` has open, which must stay open. `name`: of the file, whose extension says which
/// format is likely. A file that claims more pixels than `most_pixels` is refused, where its format allows it
/// before they are decoded.
using OpenImageFunction = OpenedImage(int descriptor, const std::string& name, uint64_t most_pixels,
                                      ImagePart part);

/// The module's one symbol, an OpenImageFunction.
inline constexpr const char* kOpenImageSymbol = "rayfarm_open_image";

}  // namespace rayfarm
