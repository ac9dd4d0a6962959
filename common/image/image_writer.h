#pragma once
// Image files written row by row: OpenEXR and PNG by the name's extension. Memory is that of some rows
// (`kReadBackBytes`), whatever the picture's size. What is written is read back in passing, by the format's
// library, and compared; the file appears under its name when all of it is there and was.
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/files/whole_file.h"
#include "common/image/image.h"

namespace rayfarm {

/// What a late attribute's value has room for: any 64-bit number.
inline constexpr size_t kLateAttributeBytes = 20;

/// About so many bytes of rows are kept until they were read back, or sixteen rows, which EXR compresses
/// together.
inline constexpr size_t kReadBackBytes = 4 << 20;

/// What a format's file is written with, into a new file; rows as ImageWriter's.
class RowWriter {
 public:
  virtual ~RowWriter() = default;
  /// Any number of whole rows. Throws std::exception with what went wrong.
  virtual void write_rows(std::span<const std::byte> rows) = 0;
  /// Ends the file, and has read back all that was not. Throws std::exception.
  virtual void finish(const std::map<std::string, std::string>& late) = 0;
};

/// For one thread at a time. After something was thrown nothing of the file is left.
class ImageWriter {
 public:
  /// EXR: the pixels' channels by their names and A (alpha 1), half or float, ZIP, scene-linear Rec.709, with
  /// the attributes. PNG: R, G and B of the window in sRGB, 8 bits. Throws IoError.
  /// \param image size, window and layout; its pixels are not read
  /// \param late names of attributes whose values `finish` brings
  ImageWriter(const std::string& path, const Image& image,
              const std::map<std::string, std::string>& attributes,
              const std::vector<std::string>& late = {});
  ImageWriter(const ImageWriter&) = delete;
  ImageWriter& operator=(const ImageWriter&) = delete;

  /// The window's next rows, each width × layout.bytes; they need not live on. Throws IoError, and
  /// std::logic_error where they are no whole rows, or more than there are.
  void write_rows(std::span<const std::byte> rows);
  /// All rows are there. Forces the file to its disk and gives it its name. Throws IoError, and
  /// std::logic_error if rows are missing, `late` has other names than were said, or values that are too
  /// long.
  void finish(const std::map<std::string, std::string>& late = {});

 private:
  int height_px_ = 0;
  size_t row_bytes_ = 0;
  int rows_ = 0;  ///< written
  std::vector<std::string> late_;
  WholeFile file_;
  std::unique_ptr<RowWriter> writer_;  ///< ends before its file does
};

}  // namespace rayfarm
