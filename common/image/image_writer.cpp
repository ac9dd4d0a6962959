#include "common/image/image_writer.h"

#include <algorithm>
#include <stdexcept>

#include "common/image/exr_file.h"
#include "common/image/image_file.h"
#include "common/image/png_file.h"

namespace rayfarm {

ImageWriter::ImageWriter(const std::string& path, const Image& image,
                         const std::map<std::string, std::string>& attributes,
                         const std::vector<std::string>& late)
    : height_px_(image.window.height()),
      row_bytes_(static_cast<size_t>(image.window.width()) * image.layout.bytes),
      late_(late),
      file_(path) {
  std::sort(late_.begin(), late_.end());
  file_.write([&](std::FILE* file) {
    writer_ = extension_of(path) == ".png" ? make_png_writer(file, image, attributes)
                                           : make_exr_writer(file, image, attributes, late_);
  });
}

void ImageWriter::write_rows(std::span<const std::byte> rows) {
  const size_t count = rows.size() / row_bytes_;
  if (rows.size() % row_bytes_ != 0 || count > static_cast<size_t>(height_px_ - rows_))
    throw std::logic_error("rows that a picture does not have");
  rows_ += static_cast<int>(count);
  file_.write([&](std::FILE*) { writer_->write_rows(rows); });
}

void ImageWriter::finish(const std::map<std::string, std::string>& late) {
  if (rows_ != height_px_) throw std::logic_error("a picture without some of its rows");
  if (!std::equal(late.begin(), late.end(), late_.begin(), late_.end(),
                  [](const auto& value, const std::string& name) {
                    return value.first == name && value.second.size() <= kLateAttributeBytes;
                  }))
    throw std::logic_error("late attributes other than those that were said");
  file_.write([&](std::FILE*) { writer_->finish(late); });
  writer_.reset();
  file_.commit();
}

}  // namespace rayfarm
