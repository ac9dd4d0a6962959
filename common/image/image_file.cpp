#include "common/image/image_file.h"

#include <ImathBox.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <openssl/evp.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "common/image/half_float.h"
#include "common/image/png_file.h"
#include "common/scene/input_error.h"

namespace rayfarm {
namespace {

double channel_value(const Image& image, size_t pixel, size_t channel) {
  const std::byte* p = image.pixels.data() + pixel * bytes_per_pixel(image.format);
  switch (image.format) {
    case PixelFormat::rgb8:
      return decode_srgb8(static_cast<uint8_t>(p[channel]));
    case PixelFormat::half_float: {
      const auto bits = static_cast<uint16_t>(static_cast<unsigned>(p[2 * channel]) |
                                              static_cast<unsigned>(p[2 * channel + 1]) << 8);
      return float_of_half(bits);
    }
    case PixelFormat::float32: {
      uint32_t bits = 0;
      for (size_t i = 0; i < 4; ++i) bits |= static_cast<uint32_t>(p[4 * channel + i]) << (8 * i);
      float f = 0;
      std::memcpy(&f, &bits, sizeof f);
      return static_cast<double>(f);
    }
  }
  return 0;
}

/// The channels of an EXR with their slices over interleaved RGBA of type T.
template <typename T>
Imf::FrameBuffer rgba_slices(std::vector<T>& rgba, const Imath::Box2i& window, Imf::PixelType type) {
  const size_t x_stride = 4 * sizeof(T);
  const size_t y_stride = x_stride * static_cast<size_t>(window.max.x - window.min.x + 1);
  Imf::FrameBuffer buffer;
  const char* names[4] = {"R", "G", "B", "A"};
  for (size_t c = 0; c < 4; ++c) {
    // OpenEXR addresses pixels by their coordinates, so the base lies before the data for a window off the
    // origin.
    char* base = reinterpret_cast<char*>(rgba.data() + c) -
                 static_cast<ptrdiff_t>(window.min.x) * static_cast<ptrdiff_t>(x_stride) -
                 static_cast<ptrdiff_t>(window.min.y) * static_cast<ptrdiff_t>(y_stride);
    buffer.insert(names[c], Imf::Slice(type, base, x_stride, y_stride));
  }
  return buffer;
}

template <typename T>
void write_exr_as(const std::string& path, const Image& image, Imf::PixelType type,
                  const std::map<std::string, std::string>& attributes) {
  const Imath::Box2i display({0, 0}, {image.width_px - 1, image.height_px - 1});
  const Imath::Box2i data({image.window.x0, image.window.y0}, {image.window.x1 - 1, image.window.y1 - 1});
  Imf::Header header(display, data, 1, Imath::V2f(0, 0), 1, Imf::INCREASING_Y, Imf::ZIP_COMPRESSION);
  for (const char* name : {"R", "G", "B", "A"}) header.channels().insert(name, Imf::Channel(type));
  Imf::addChromaticities(header, Imf::Chromaticities());  // Rec. ITU-R BT.709-3
  for (const auto& [name, value] : attributes) header.insert(name, Imf::StringAttribute(value));

  const auto pixels = static_cast<size_t>(image.window.area());
  std::vector<T> rgba(4 * pixels);
  for (size_t i = 0; i < pixels; ++i) {
    for (size_t c = 0; c < 3; ++c) rgba[4 * i + c] = T(static_cast<float>(channel_value(image, i, c)));
    rgba[4 * i + 3] = T(1.0f);
  }
  {
    Imf::OutputFile file(path.c_str(), header, 1);
    file.setFrameBuffer(rgba_slices(rgba, data, type));
    file.writePixels(image.window.height());
  }
  std::vector<T> back(4 * pixels);
  Imf::InputFile file(path.c_str(), 1);
  file.setFrameBuffer(rgba_slices(back, data, type));
  file.readPixels(data.min.y, data.max.y);
  if (std::memcmp(rgba.data(), back.data(), rgba.size() * sizeof(T)) != 0)
    throw IoError("what was read back differs from what was written");
}

void write_exr(const std::string& path, const Image& image,
               const std::map<std::string, std::string>& attributes) {
  if (image.format == PixelFormat::float32)
    write_exr_as<float>(path, image, Imf::FLOAT, attributes);
  else
    write_exr_as<Imath::half>(path, image, Imf::HALF, attributes);
}

std::vector<std::byte> rgb8_of(const Image& image) {
  if (image.format == PixelFormat::rgb8) return image.pixels;
  const auto pixels = static_cast<size_t>(image.window.area());
  std::vector<std::byte> bytes(3 * pixels);
  for (size_t i = 0; i < pixels; ++i)
    for (size_t c = 0; c < 3; ++c)
      bytes[3 * i + c] = static_cast<std::byte>(encode_srgb8(channel_value(image, i, c)));
  return bytes;
}

/// OpenImageIO's module, which stands beside the executable or in ../lib; a test's executable stands below.
ReadImageFunction* load_reader() {
  static ReadImageFunction* const reader = [] {
    const std::filesystem::path folder = std::filesystem::read_symlink("/proc/self/exe").parent_path();
    void* module = nullptr;
    for (const char* place : {".", "../lib", ".."}) {
      const std::filesystem::path path = folder / place / "rayfarm_image_formats.so";
      if (module || !std::filesystem::exists(path)) continue;
      module = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
      if (!module)
        throw IoError(fmt::format("OpenImageIO can't be loaded: {}; ./deploy/setup installs it", dlerror()));
    }
    void* symbol = module ? dlsym(module, kReadImageSymbol) : nullptr;
    if (!symbol)
      throw IoError(
          fmt::format("OpenImageIO can't be loaded: rayfarm_image_formats.so is missing; it belongs beside "
                      "the executable ({}) or in ../lib",
                      folder.string()));
    return reinterpret_cast<ReadImageFunction*>(symbol);
  }();
  return reader;
}

/// Forces the file to its disk, so that a full one shows here.
void sync_file(const std::string& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const bool ok = file >= 0 && fsync(file) == 0;
  const int error = errno;
  if (file >= 0) close(file);
  if (!ok) throw IoError(std::strerror(error));
}

}  // namespace

std::string extension_of(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

bool is_writable_image(const std::string& path) {
  const std::string extension = extension_of(path);
  return extension == ".exr" || extension == ".png";
}

PixelFormat natural_format(const std::string& path) {
  return extension_of(path) == ".png" ? PixelFormat::rgb8 : PixelFormat::half_float;
}

void write_image(const std::string& path, const Image& image,
                 const std::map<std::string, std::string>& attributes) {
  const std::filesystem::path target(path);
  const std::string temporary =
      (target.parent_path() / fmt::format(".{}.{}.part", target.filename().string(), getpid())).string();
  try {
    if (extension_of(path) == ".png")
      write_png(temporary, image.window.width(), image.window.height(), rgb8_of(image), attributes);
    else
      write_exr(temporary, image, attributes);
    sync_file(temporary);
    std::filesystem::rename(temporary, target);
  } catch (const std::exception& e) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw IoError(fmt::format(
        "{}: can't be written: {}; check the folder, its permissions and the space left", path, e.what()));
  }
}

ReadImage read_image(const std::string& path) {
  ReadImage image;
  const std::string error = load_reader()(path, image);
  if (!error.empty()) throw IoError(fmt::format("{}: can't be read: {}", path, error));
  return image;
}

std::string sha256(std::span<const std::byte> bytes) {
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned int size = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), digest, &size, EVP_sha256(), nullptr) != 1)
    throw IoError("SHA-256 is not available");
  std::string text;
  for (unsigned int i = 0; i < size; ++i) text += fmt::format("{:02x}", digest[i]);
  return text;
}

}  // namespace rayfarm
