#pragma once
// Image files: OpenEXR and PNG. A file appears under its name only when it is whole (image_writer.h).
#include "common/files/regular_file.h"
#include "common/image/formats/image_formats.h"
#include "common/image/image.h"

namespace rayfarm {

/// The file name's extension in small letters, with its dot.
std::string extension_of(const std::string& path);

/// True if `path` ends in an extension that can be written: .exr or .png.
bool is_writable_image(const std::string& path);
/// True if files of this name hold linear light, false if they hold sRGB.
bool holds_linear_light(const std::string& path);
/// What a file of this name holds: PNG rgb8, EXR half.
PixelFormat natural_format(const std::string& path);

/// Writes by extension, as an ImageWriter does that has all rows at once. Throws IoError; nothing is left
/// behind then.
void write_image(const std::string& path, const Image& image,
                 const std::map<std::string, std::string>& attributes);

/// What an .exr or .png says of itself before its pixels, which are not read. Throws IoError.
ImageInfo read_image_info(const std::string& path);
/// Reads an .exr or .png to its end. Throws IoError if it is empty, cut off or damaged.
void check_image_whole(const std::string& path);

/// An image's file, or the bytes of one that stands in another file: `name` is then what messages call it,
/// and its extension tells the format that is likely.
struct ImageFile {
  ImageFile(std::string path) : name(std::move(path)) {}
  ImageFile(std::string of_name, std::span<const std::byte> content)
      : name(std::move(of_name)), bytes(content) {}
  std::string name;
  std::optional<std::span<const std::byte>> bytes;
};

/// Reads an image of any format row by row from the top, as floats in the encoding of its file.
class ImageReader {
 public:
  /// Throws IoError if it can't be read, has more than `most_pixels`, or claims more than its bytes can hold.
  ImageReader(const ImageFile& file, uint64_t most_pixels, ImagePart part = ImagePart::color);
  int width_px() const { return source_->width_px; }
  int height_px() const { return source_->height_px; }
  bool has_alpha() const { return source_->has_alpha; }
  /// The next row, width × 3, until the next call. Throws IoError.
  std::span<const float> next_row();

 private:
  [[noreturn]] void fail(const std::string& problem) const;

  std::string path_;
  RegularFile opened_;
  std::unique_ptr<ImageSource> source_;
  std::vector<float> block_;
  int row_ = 0;
};

}  // namespace rayfarm
