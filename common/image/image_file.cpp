#include "common/image/image_file.h"

#include <dlfcn.h>

#include <filesystem>

#include "common/errors/input_error.h"
#include "common/files/regular_file.h"
#include "common/image/exr_file.h"
#include "common/image/image_writer.h"
#include "common/image/png_file.h"

namespace rayfarm {
namespace {

/// Deflate, the best of what most formats compress with, makes 1,032 bytes of one at most (zlib's technical
/// notes), and a byte may hold eight pixels.
constexpr uint64_t kMostPixelsPerByte = 8 * 1032;
/// So few need no such proof: a format that stores a plain area as a few numbers may hold them in a few
/// bytes.
constexpr uint64_t kPixelsOfAnyFile = 1 << 22;

constexpr const char* kModule = "rayfarm_image_formats.so";

/// OpenImageIO's module, which stands beside the executable or in ../lib/rayfarm; a test's executable stands
/// below. Programs that link the installed library know its folder from their run path.
OpenImageFunction* load_reader() {
  static OpenImageFunction* const reader = [] {
    const std::filesystem::path folder = std::filesystem::read_symlink("/proc/self/exe").parent_path();
    void* module = nullptr;
    for (const char* place : {".", "../lib/rayfarm", ".."}) {
      const std::filesystem::path path = folder / place / kModule;
      if (module || !std::filesystem::exists(path)) continue;
      module = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
      if (!module)
        throw IoError(fmt::format("OpenImageIO can't be loaded: {}; ./deploy/setup installs it", dlerror()));
    }
    if (!module) module = dlopen(kModule, RTLD_NOW | RTLD_LOCAL);
    void* symbol = module ? dlsym(module, kOpenImageSymbol) : nullptr;
    if (!symbol)
      throw IoError(fmt::format(
          "OpenImageIO can't be loaded: {}; it belongs beside the executable ({}), in ../lib/rayfarm "
          "or in a folder of its run path",
          dlerror(), folder.string()));
    return reinterpret_cast<OpenImageFunction*>(symbol);
  }();
  return reader;
}

/// Opens the file and calls `work` with it by what its name says. What it throws becomes an IoError.
template <typename OfPng, typename OfExr>
auto with_image(const std::string& path, OfPng of_png, OfExr of_exr) {
  const RegularFile opened = open_regular_file(path);
  try {
    if (opened.size_bytes == 0) throw std::runtime_error("the file is empty");
    return extension_of(path) == ".png" ? of_png(opened.file.get()) : of_exr(opened.file.get());
  } catch (const std::exception& e) {
    throw IoError(fmt::format("{}: is not a whole picture: {}", path, e.what()));
  }
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

bool holds_linear_light(const std::string& path) {
  const std::string extension = extension_of(path);
  return extension == ".exr" || extension == ".hdr" || extension == ".pfm";
}

PixelFormat natural_format(const std::string& path) {
  return extension_of(path) == ".png" ? PixelFormat::rgb8 : PixelFormat::half_float;
}

void write_image(const std::string& path, const Image& image,
                 const std::map<std::string, std::string>& attributes) {
  ImageWriter writer(path, image, attributes);
  writer.write_rows(image.pixels);
  writer.finish();
}

ImageInfo read_image_info(const std::string& path) {
  return with_image(path, read_png_info, read_exr_info);
}

void check_image_whole(const std::string& path) {
  with_image(path, check_png, check_exr);
}

ImageReader::ImageReader(const ImageFile& file, uint64_t most_pixels, ImagePart part)
    : path_(file.name), opened_(file.bytes ? open_bytes(*file.bytes) : open_regular_file(file.name)) {
  // libpng would tell of it on stderr, in its own words.
  if (const std::string damage = find_png_damage(opened_.file.get()); !damage.empty()) fail(damage);
  OpenedImage image = load_reader()(fileno(opened_.file.get()), path_, most_pixels, part);
  if (!image.source) fail(image.problem);
  source_ = std::move(image.source);
  if (width_px() <= 0 || height_px() <= 0)
    fail(fmt::format("it has {} × {} pixels, which is no picture", width_px(), height_px()));
  const uint64_t pixels = static_cast<uint64_t>(width_px()) * static_cast<uint64_t>(height_px());
  if (pixels > kPixelsOfAnyFile && pixels / kMostPixelsPerByte > opened_.size_bytes)
    fail(fmt::format("it claims {} × {} pixels, which {} bytes can't hold; the file is damaged or cut off",
                     width_px(), height_px(), opened_.size_bytes));
  if (pixels > most_pixels)
    fail(fmt::format("it has {} × {} pixels, more than the {} that may be read; scale it down", width_px(),
                     height_px(), most_pixels));
}

void ImageReader::fail(const std::string& problem) const {
  throw IoError(fmt::format("{}: can't be read: {}", path_, problem));
}

std::span<const float> ImageReader::next_row() {
  const size_t stride = 3 * static_cast<size_t>(width_px());
  const int in_block = row_ % source_->rows_at_once;
  if (in_block == 0) {
    const int count = std::min(source_->rows_at_once, height_px() - row_);
    block_.resize(static_cast<size_t>(count) * stride);
    if (const std::string problem = source_->read_rows(row_, count, block_.data()); !problem.empty())
      fail(problem);
  }
  ++row_;
  return std::span(block_).subspan(static_cast<size_t>(in_block) * stride, stride);
}

}  // namespace rayfarm
