#include "common/image/png_file.h"

#include <png.h>

#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <vector>

namespace rayfarm {
namespace {

/// What libpng calls when it fails; it must not return.
[[noreturn]] void keep_message_and_jump(png_structp png, png_const_charp message) {
  *static_cast<std::string*>(png_get_error_ptr(png)) = message;
  png_longjmp(png, 1);
}

struct Writer {
  explicit Writer(std::string* message)
      : png(png_create_write_struct(PNG_LIBPNG_VER_STRING, message, keep_message_and_jump, nullptr)),
        info(png ? png_create_info_struct(png) : nullptr) {}
  ~Writer() { png_destroy_write_struct(&png, &info); }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
  png_structp png;
  png_infop info;
};

/// All that can jump, in a function without objects to destroy. False if it failed.
bool write_all(const Writer& writer, FILE* file, png_uint_32 width, png_uint_32 height,
               std::span<png_text> texts, png_bytepp rows) {
  if (setjmp(png_jmpbuf(writer.png))) return false;
  png_init_io(writer.png, file);
  png_set_IHDR(writer.png, writer.info, width, height, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB_gAMA_and_cHRM(writer.png, writer.info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_set_text(writer.png, writer.info, texts.data(), static_cast<int>(texts.size()));
  png_write_info(writer.png, writer.info);
  png_write_image(writer.png, rows);
  png_write_end(writer.png, nullptr);
  return true;
}

std::vector<std::byte> read_rgb(const std::string& path) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  std::vector<std::byte> rgb;
  if (png_image_begin_read_from_file(&image, path.c_str())) {
    image.format = PNG_FORMAT_RGB;
    rgb.resize(PNG_IMAGE_SIZE(image));
    png_image_finish_read(&image, nullptr, rgb.data(), 0, nullptr);
  }
  const std::string message = PNG_IMAGE_FAILED(image) ? image.message : "";
  png_image_free(&image);
  if (!message.empty()) throw std::runtime_error(message);
  return rgb;
}

}  // namespace

void write_png(const std::string& path, int width_px, int height_px, std::span<const std::byte> rgb,
               const std::map<std::string, std::string>& attributes) {
  const size_t stride = 3 * static_cast<size_t>(width_px);
  std::vector<png_bytep> rows;
  for (size_t y = 0; y < static_cast<size_t>(height_px); ++y)
    rows.push_back(reinterpret_cast<png_bytep>(const_cast<std::byte*>(rgb.data()) + y * stride));
  std::vector<png_text> texts;
  for (const auto& [name, value] : attributes) {
    png_text text{};
    text.compression = PNG_TEXT_COMPRESSION_NONE;
    text.key = const_cast<char*>(name.c_str());
    text.text = const_cast<char*>(value.c_str());
    text.text_length = value.size();
    texts.push_back(text);
  }
  const std::unique_ptr<FILE, int (*)(FILE*)> file(std::fopen(path.c_str(), "wb"), &std::fclose);
  if (!file) throw std::runtime_error(std::strerror(errno));
  std::string message = "no memory";
  const Writer writer(&message);
  if (!writer.info || !write_all(writer, file.get(), static_cast<png_uint_32>(width_px),
                                 static_cast<png_uint_32>(height_px), texts, rows.data()))
    throw std::runtime_error(message);
  if (std::fflush(file.get()) != 0) throw std::runtime_error(std::strerror(errno));
  const std::vector<std::byte> back = read_rgb(path);
  if (back.size() != rgb.size() || std::memcmp(back.data(), rgb.data(), rgb.size()) != 0)
    throw std::runtime_error("what was read back differs from what was written");
}

}  // namespace rayfarm
