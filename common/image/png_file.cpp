#include "common/image/png_file.h"

#include <fmt/core.h>
#include <png.h>
#include <unistd.h>
#include <zlib.h>

#include <array>
#include <cerrno>
#include <csetjmp>
#include <cstring>
#include <span>
#include <stdexcept>

#include "common/image/colour_channels.h"

namespace rayfarm {
namespace {

/// What libpng calls when it fails; it must not return.
[[noreturn]] void keep_message_and_jump(png_structp png, png_const_charp message) {
  *static_cast<std::string*>(png_get_error_ptr(png)) = message;
  png_longjmp(png, 1);
}
void ignore(png_structp, png_const_charp) {}

/// Calls `work`, which libpng may jump out of: nothing in it may need destruction.
template <typename Work>
void guarded(png_structp png, const std::string& message, Work work) {
  if (setjmp(png_jmpbuf(png))) throw std::runtime_error(message);
  work();
}

class Writer {
 public:
  explicit Writer(std::FILE* file)
      : png_(png_create_write_struct(PNG_LIBPNG_VER_STRING, &message_, keep_message_and_jump, ignore)),
        info_(png_ ? png_create_info_struct(png_) : nullptr) {
    if (!info_) throw std::bad_alloc();
    png_init_io(png_, file);
  }
  ~Writer() { png_destroy_write_struct(&png_, &info_); }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  void write_header(int width_px, int height_px, std::span<png_text> texts) {
    guarded(png_, message_, [&] {
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
  void write_row(std::span<const std::byte> rgb) {
    guarded(png_, message_, [&] { png_write_row(png_, reinterpret_cast<png_const_bytep>(rgb.data())); });
  }
  void finish() {
    guarded(png_, message_, [&] { png_write_end(png_, nullptr); });
  }

 private:
  std::string message_;
  png_structp png_;
  png_infop info_;
};

class Reader {
 public:
  /// From the file's beginning to its pixels.
  explicit Reader(std::FILE* file)
      : png_(png_create_read_struct(PNG_LIBPNG_VER_STRING, &message_, keep_message_and_jump, ignore)),
        info_(png_ ? png_create_info_struct(png_) : nullptr) {
    try {
      if (!info_) throw std::bad_alloc();
      if (fseeko(file, 0, SEEK_SET) != 0) throw std::runtime_error(std::strerror(errno));
      png_init_io(png_, file);
      guarded(png_, message_, [&] {
        png_set_crc_action(png_, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
        png_set_benign_errors(png_, 0);
        png_read_info(png_, info_);
      });
    } catch (...) {
      destroy();
      throw;
    }
  }
  ~Reader() { destroy(); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  int width_px() const { return static_cast<int>(png_get_image_width(png_, info_)); }
  int height_px() const { return static_cast<int>(png_get_image_height(png_, info_)); }
  bool is_rgb8() const {
    return png_get_color_type(png_, info_) == PNG_COLOR_TYPE_RGB && png_get_bit_depth(png_, info_) == 8;
  }
  size_t row_bytes() const { return png_get_rowbytes(png_, info_); }
  std::span<const png_text> texts() const {
    png_textp texts = nullptr;
    const int count = png_get_text(png_, info_, &texts, nullptr);
    return {texts, static_cast<size_t>(count)};
  }
  /// How often the rows come: an interlaced file holds them in several passes.
  int passes() {
    int count = 1;
    guarded(png_, message_, [&] { count = png_set_interlace_handling(png_); });
    return count;
  }
  void read_row(std::span<std::byte> row) {
    guarded(png_, message_, [&] { png_read_row(png_, reinterpret_cast<png_bytep>(row.data()), nullptr); });
  }
  void finish() {
    guarded(png_, message_, [&] { png_read_end(png_, nullptr); });
  }

 private:
  void destroy() { png_destroy_read_struct(&png_, &info_, nullptr); }

  std::string message_;
  png_structp png_;
  png_infop info_;
};

/// The row of the window as sRGB bytes: the image's own, or converted into `converted`.
std::span<const std::byte> rgb8_row(const Image& image, int y, std::vector<std::byte>& converted) {
  const auto width = static_cast<size_t>(image.window.width());
  const size_t first = static_cast<size_t>(y) * width;
  if (image.layout.is_rgb8()) return std::span(image.pixels).subspan(3 * first, 3 * width);
  const std::array<PixelChannel, 3> channels = colour_channels(image.layout);
  converted.resize(3 * width);
  const std::byte* pixel = image.pixels.data() + first * image.layout.bytes;
  for (size_t x = 0; x < width; ++x, pixel += image.layout.bytes)
    for (size_t c = 0; c < 3; ++c)
      converted[3 * x + c] = static_cast<std::byte>(encode_srgb8(decode_value(channels[c], pixel)));
  return converted;
}

}  // namespace

void write_png(std::FILE* file, const Image& image, const std::map<std::string, std::string>& attributes) {
  std::vector<png_text> texts;
  for (const auto& [name, value] : attributes) {
    png_text text{};
    text.compression = PNG_TEXT_COMPRESSION_NONE;
    text.key = const_cast<char*>(name.c_str());
    text.text = const_cast<char*>(value.c_str());
    text.text_length = value.size();
    texts.push_back(text);
  }
  const int height = image.window.height();
  std::vector<std::byte> converted;
  Writer writer(file);
  writer.write_header(image.window.width(), height, texts);
  for (int y = 0; y < height; ++y) writer.write_row(rgb8_row(image, y, converted));
  writer.finish();
  if (std::fflush(file) != 0) throw std::runtime_error(std::strerror(errno));

  Reader reader(file);
  bool is_same =
      reader.width_px() == image.window.width() && reader.height_px() == height && reader.is_rgb8();
  std::vector<std::byte> back(reader.row_bytes());
  for (int y = 0; is_same && y < height; ++y) {
    reader.read_row(back);
    is_same = std::memcmp(back.data(), rgb8_row(image, y, converted).data(), back.size()) == 0;
  }
  if (!is_same) throw std::runtime_error("what was read back differs from what was written");
  reader.finish();
}

ImageInfo read_png_info(std::FILE* file) {
  const Reader reader(file);
  ImageInfo info{
      reader.width_px(), reader.height_px(), {0, 0, reader.width_px(), reader.height_px()}, {}, {}};
  if (reader.is_rgb8()) info.format = PixelFormat::rgb8;
  for (const png_text& text : reader.texts()) info.attributes[text.key] = text.text;
  return info;
}

void check_png(std::FILE* file) {
  Reader reader(file);
  const int passes = reader.passes();
  std::vector<std::byte> row(reader.row_bytes());
  for (int pass = 0; pass < passes; ++pass)
    for (int y = 0; y < reader.height_px(); ++y) reader.read_row(row);
  reader.finish();
}

std::string find_png_damage(std::FILE* file) {
  constexpr std::string_view kSignature = "\x89PNG\r\n\x1a\n";
  std::vector<unsigned char> bytes(1 << 16);
  off_t at = 0;
  const auto read = [&](size_t count) {
    size_t done = 0;
    for (ssize_t n = 1; done < count && n > 0; done += n > 0 ? static_cast<size_t>(n) : 0)
      n = pread(fileno(file), bytes.data() + done, count - done, at + static_cast<off_t>(done));
    at += static_cast<off_t>(done);
    return done == count;
  };
  const auto number = [&] {
    return uint32_t{bytes[0]} << 24 | uint32_t{bytes[1]} << 16 | uint32_t{bytes[2]} << 8 | bytes[3];
  };
  if (!read(kSignature.size()) || std::memcmp(bytes.data(), kSignature.data(), kSignature.size()) != 0)
    return "";
  constexpr const char* kCutOff = "it ends before its last chunk (IEND); the file is cut off";
  for (;;) {
    const off_t begin = at;
    if (!read(8)) return kCutOff;
    uint32_t left = number();
    const std::string name(reinterpret_cast<const char*>(bytes.data()) + 4, 4);
    uLong sum = crc32(0, bytes.data() + 4, 4);
    while (left > 0) {
      const auto piece = static_cast<uint32_t>(std::min<size_t>(left, bytes.size()));
      if (!read(piece)) return kCutOff;
      sum = crc32(sum, bytes.data(), piece);
      left -= piece;
    }
    if (!read(4)) return kCutOff;
    const bool is_needed = name[0] >= 'A' && name[0] <= 'Z';
    if (is_needed && number() != sum)
      return fmt::format("the checksum of its chunk at byte {} is wrong; the file is damaged", begin);
    if (name == "IEND") return "";
  }
}

}  // namespace rayfarm
