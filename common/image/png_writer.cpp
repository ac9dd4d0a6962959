#include <cerrno>
#include <cstring>

#include "common/files/regular_file.h"
#include "common/image/colour_channels.h"
#include "common/image/png_file.h"
#include "common/image/png_guard.h"

namespace rayfarm {
namespace {

constexpr const char* kDifferent = "what was read back differs from what was written";

/// A text chunk for each attribute, which must outlive them.
std::vector<png_text> make_texts(const std::map<std::string, std::string>& attributes) {
  std::vector<png_text> texts;
  for (const auto& [name, value] : attributes) {
    png_text text{};
    text.compression = PNG_TEXT_COMPRESSION_NONE;
    text.key = const_cast<char*>(name.c_str());
    text.text = const_cast<char*>(value.c_str());
    text.text_length = value.size();
    texts.push_back(text);
  }
  return texts;
}

class PngOutput {
 public:
  explicit PngOutput(std::FILE* file)
      : png_(png_create_write_struct(PNG_LIBPNG_VER_STRING, &message_, keep_png_message, ignore_png_message)),
        info_(png_ ? png_create_info_struct(png_) : nullptr),
        end_(info_ ? png_create_info_struct(png_) : nullptr) {
    if (!end_) {
      destroy();
      throw std::bad_alloc();
    }
    png_init_io(png_, file);
  }
  ~PngOutput() { destroy(); }
  PngOutput(const PngOutput&) = delete;
  PngOutput& operator=(const PngOutput&) = delete;

  void write_header(int width_px, int height_px, std::span<png_text> texts) {
    png_guarded(png_, message_, [&] {
      png_set_IHDR(png_, info_, static_cast<png_uint_32>(width_px), static_cast<png_uint_32>(height_px), 8,
                   PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                   PNG_FILTER_TYPE_DEFAULT);
      // A third of the time that libpng's own choice takes, for files that are up to half as large again.
      png_set_filter(png_, PNG_FILTER_TYPE_BASE, PNG_FILTER_UP);
      png_set_compression_level(png_, 3);
      png_set_sRGB_gAMA_and_cHRM(png_, info_, PNG_sRGB_INTENT_PERCEPTUAL);
      png_set_text(png_, info_, texts.data(), static_cast<int>(texts.size()));
      png_write_info(png_, info_);
    });
  }
  void write_row(const std::byte* rgb) {
    png_guarded(png_, message_, [&] { png_write_row(png_, reinterpret_cast<png_const_bytep>(rgb)); });
  }
  void finish(std::span<png_text> texts) {
    png_guarded(png_, message_, [&] {
      png_set_text(png_, end_, texts.data(), static_cast<int>(texts.size()));
      png_write_end(png_, end_);
    });
  }

 private:
  void destroy() {
    png_destroy_info_struct(png_, &end_);
    png_destroy_write_struct(&png_, &info_);
  }

  std::string message_;
  png_structp png_;
  png_infop info_;
  png_infop end_;  ///< what stands after the pixels
};

/// Reads the file as it grows, and compares its rows with those that are expected.
class PngComparison {
 public:
  PngComparison(std::FILE* file, int width_px, int height_px)
      : file_(file),
        width_px_(width_px),
        height_px_(height_px),
        png_(png_create_read_struct(PNG_LIBPNG_VER_STRING, &message_, keep_png_message, ignore_png_message)),
        info_(png_ ? png_create_info_struct(png_) : nullptr) {
    if (!info_) {
      destroy();
      throw std::bad_alloc();
    }
    png_guarded(png_, message_, [&] {
      refuse_png_damage(png_);
      png_set_progressive_read_fn(png_, this, take_header, take_row, take_end);
    });
  }
  ~PngComparison() { destroy(); }
  PngComparison(const PngComparison&) = delete;
  PngComparison& operator=(const PngComparison&) = delete;

  /// Reads what has come to the file; `rows`: what was written and not compared yet. How many bytes of it
  /// were: the compressor keeps some back.
  size_t go_on(std::span<const std::byte> rows) {
    expected_ = rows;
    block_.resize(1 << 16);
    while (const size_t count = read_at(file_, position_, block_)) {
      position_ += count;
      png_guarded(png_, message_,
                  [&] { png_process_data(png_, info_, reinterpret_cast<png_bytep>(block_.data()), count); });
    }
    return rows.size() - expected_.size();
  }

  /// All was read: throws if the file doesn't end there, or an attribute is not in it.
  void finish(const std::map<std::string, std::string>& attributes) const {
    png_textp texts = nullptr;
    const int count = png_get_text(png_, info_, &texts, nullptr);
    size_t same = 0;
    for (int i = 0; i < count; ++i) {
      const auto found = attributes.find(texts[i].key);
      same += found != attributes.end() && found->second == texts[i].text;
    }
    if (!is_at_end_ || same != attributes.size()) throw std::runtime_error(kDifferent);
  }

 private:
  static PngComparison& self(png_structp png) {
    return *static_cast<PngComparison*>(png_get_progressive_ptr(png));
  }
  static void take_header(png_structp png, png_infop info) {
    const PngComparison& self_ = self(png);
    if (png_get_image_width(png, info) != static_cast<png_uint_32>(self_.width_px_) ||
        png_get_image_height(png, info) != static_cast<png_uint_32>(self_.height_px_) ||
        png_get_color_type(png, info) != PNG_COLOR_TYPE_RGB || png_get_bit_depth(png, info) != 8)
      png_error(png, kDifferent);
    png_start_read_image(png);
  }
  static void take_row(png_structp png, png_bytep row, png_uint_32, int) {
    std::span<const std::byte>& expected = self(png).expected_;
    const size_t bytes = 3 * static_cast<size_t>(self(png).width_px_);
    if (!row || expected.size() < bytes || std::memcmp(row, expected.data(), bytes) != 0)
      png_error(png, kDifferent);
    expected = expected.subspan(bytes);
  }
  static void take_end(png_structp png, png_infop) { self(png).is_at_end_ = true; }
  void destroy() { png_destroy_read_struct(&png_, &info_, nullptr); }

  std::FILE* file_;
  int width_px_, height_px_;
  std::string message_;
  png_structp png_;
  png_infop info_;
  uint64_t position_ = 0;  ///< read up to there
  std::span<const std::byte> expected_;
  std::vector<std::byte> block_;
  bool is_at_end_ = false;
};

class PngWriter : public RowWriter {
 public:
  PngWriter(std::FILE* file, const Image& image, const std::map<std::string, std::string>& attributes)
      : file_(file),
        layout_(image.layout),
        channels_(colour_channels(image.layout)),
        width_(static_cast<size_t>(image.window.width())),
        attributes_(attributes),
        output_(file),
        comparison_(file, image.window.width(), image.window.height()) {
    std::vector<png_text> texts = make_texts(attributes_);
    output_.write_header(image.window.width(), image.window.height(), texts);
  }

  void write_rows(std::span<const std::byte> rows) override {
    const size_t row_bytes = width_ * layout_.bytes;
    for (; !rows.empty(); rows = rows.subspan(row_bytes)) {
      const size_t at = waiting_.size();
      append(rows.first(row_bytes));
      output_.write_row(waiting_.data() + at);
      if (waiting_.size() - compared_at_ >= kReadBackBytes) read_back();
    }
  }

  void finish(const std::map<std::string, std::string>& late) override {
    std::vector<png_text> texts = make_texts(late);
    output_.finish(texts);
    read_back();
    attributes_.insert(late.begin(), late.end());
    comparison_.finish(attributes_);
    if (!waiting_.empty()) throw std::runtime_error(kDifferent);
  }

 private:
  /// The row as sRGB bytes.
  void append(std::span<const std::byte> row) {
    if (layout_.is_rgb8()) {
      waiting_.insert(waiting_.end(), row.begin(), row.end());
      return;
    }
    for (; !row.empty(); row = row.subspan(layout_.bytes))
      for (const PixelChannel& channel : channels_)
        waiting_.push_back(static_cast<std::byte>(encode_srgb8(decode_value(channel, row.data()))));
  }

  void read_back() {
    if (std::fflush(file_) != 0) throw std::runtime_error(std::strerror(errno));
    const size_t compared = comparison_.go_on(waiting_);
    waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<ptrdiff_t>(compared));
    compared_at_ = waiting_.size();
  }

  std::FILE* file_;
  PixelLayout layout_;
  std::array<PixelChannel, 3> channels_;
  size_t width_;
  std::map<std::string, std::string> attributes_;
  PngOutput output_;
  PngComparison comparison_;
  /// Rows that are written and not compared. Of a plain picture zlib and libpng hold up to a dozen megabytes
  /// back as a few kilobytes that are no chunk yet.
  std::vector<std::byte> waiting_;
  size_t compared_at_ = 0;  ///< bytes of `waiting_` that stood there when the file was last read
};

}  // namespace

std::unique_ptr<RowWriter> make_png_writer(std::FILE* file, const Image& image,
                                           const std::map<std::string, std::string>& attributes) {
  return std::make_unique<PngWriter>(file, image, attributes);
}

}  // namespace rayfarm
