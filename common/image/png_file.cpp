#include "common/image/png_file.h"

#include <fmt/core.h>
#include <zlib.h>

#include <cerrno>
#include <cstring>
#include <span>
#include <stdexcept>

#include "common/files/regular_file.h"
#include "common/image/png_guard.h"

namespace rayfarm {
namespace {

class Reader {
 public:
  /// From the file's beginning to its pixels.
  explicit Reader(std::FILE* file)
      : png_(png_create_read_struct(PNG_LIBPNG_VER_STRING, &message_, keep_png_message, ignore_png_message)),
        info_(png_ ? png_create_info_struct(png_) : nullptr) {
    try {
      if (!info_) throw std::bad_alloc();
      if (fseeko(file, 0, SEEK_SET) != 0) throw std::runtime_error(std::strerror(errno));
      png_init_io(png_, file);
      png_guarded(png_, message_, [&] {
        refuse_png_damage(png_);
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
    png_guarded(png_, message_, [&] { count = png_set_interlace_handling(png_); });
    return count;
  }
  void read_row(std::span<std::byte> row) {
    png_guarded(png_, message_,
                [&] { png_read_row(png_, reinterpret_cast<png_bytep>(row.data()), nullptr); });
  }
  void finish() {
    png_guarded(png_, message_, [&] { png_read_end(png_, nullptr); });
  }

 private:
  void destroy() { png_destroy_read_struct(&png_, &info_, nullptr); }

  std::string message_;
  png_structp png_;
  png_infop info_;
};

/// How the last chunk of a PNG file looks: no bytes, its name, its checksum.
constexpr std::string_view kEnd("\0\0\0\0IEND\xae\x42\x60\x82", 12);
/// A chunk's length and name before its bytes, and its checksum after them.
constexpr size_t kChunkFrameBytes = 12;
/// Texts after the pixels that are looked for, those of attributes that come late, are shorter than that all
/// together.
constexpr size_t kMostTailBytes = 1 << 14;

uint32_t big_endian(std::string_view bytes) {
  uint32_t value = 0;
  for (size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<uint8_t>(bytes[i]);
  return value;
}

/// Adds the texts that stand right before the file's end. They are found from there, because the way through
/// the chunks of the pixels would be that through the whole file.
void add_late_texts(std::FILE* file, std::map<std::string, std::string>& attributes) {
  if (fseeko(file, 0, SEEK_END) != 0) throw std::runtime_error(std::strerror(errno));
  const auto size = static_cast<uint64_t>(ftello(file));
  std::string bytes(std::min<uint64_t>(size, kMostTailBytes), '\0');
  read_at(file, size - bytes.size(), std::as_writable_bytes(std::span(bytes)));
  std::string_view tail(bytes);
  if (!tail.ends_with(kEnd)) return;
  tail.remove_suffix(kEnd.size());
  for (size_t at = tail.rfind("tEXt"); at != std::string_view::npos && at >= 4;
       at = tail.rfind("tEXt", at - 1)) {
    const std::string_view chunk = tail.substr(at - 4);
    const uint32_t length = big_endian(chunk);
    if (chunk.size() < kChunkFrameBytes || length != chunk.size() - kChunkFrameBytes) continue;
    const std::string_view checked = chunk.substr(4, 4 + size_t{length}), text = checked.substr(4);
    const uLong sum =
        crc32(0, reinterpret_cast<const Bytef*>(checked.data()), static_cast<uInt>(checked.size()));
    const size_t key = text.find('\0');
    if (sum != big_endian(chunk.substr(8 + size_t{length})) || key == std::string_view::npos) continue;
    attributes.emplace(text.substr(0, key), text.substr(key + 1));
    tail.remove_suffix(chunk.size());
    at = tail.size();
    if (at == 0) return;
  }
}

}  // namespace

ImageInfo read_png_info(std::FILE* file) {
  const Reader reader(file);
  ImageInfo info{
      reader.width_px(), reader.height_px(), {0, 0, reader.width_px(), reader.height_px()}, {}, {}};
  if (reader.is_rgb8()) info.format = PixelFormat::rgb8;
  for (const png_text& text : reader.texts()) info.attributes[text.key] = text.text;
  add_late_texts(file, info.attributes);
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
  uint64_t at = 0;
  const auto read = [&](size_t count) {
    const size_t done = read_at(file, at, std::as_writable_bytes(std::span(bytes)).first(count));
    at += done;
    return done == count;
  };
  const auto number = [&] {
    return uint32_t{bytes[0]} << 24 | uint32_t{bytes[1]} << 16 | uint32_t{bytes[2]} << 8 | bytes[3];
  };
  if (!read(kSignature.size()) || std::memcmp(bytes.data(), kSignature.data(), kSignature.size()) != 0)
    return "";
  constexpr const char* kCutOff = "it ends before its last chunk (IEND); the file is cut off";
  for (;;) {
    const uint64_t begin = at;
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
