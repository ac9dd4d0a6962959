#include "common/image/formats/image_formats.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <exception>

namespace rayfarm {
namespace {

class OiioSource : public ImageSource {
 public:
  explicit OiioSource(std::unique_ptr<OIIO::ImageInput> in) : in_(std::move(in)), spec_(in_->spec()) {
    constexpr int kScanlines = 32;
    width_px = spec_.width;
    height_px = spec_.height;
    rows_at_once = spec_.tile_width > 0 ? std::max(1, spec_.tile_height) : std::min(height_px, kScanlines);
  }
  std::string read_rows(int y, int count, float* rgb) override {
    const int begin = spec_.y + y, end = begin + count;
    try {
      const bool is_read =
          spec_.tile_width > 0
              ? in_->read_tiles(0, 0, spec_.x, spec_.x + spec_.width, begin, end, spec_.z, spec_.z + 1, 0, 3,
                                OIIO::TypeDesc::FLOAT, rgb)
              : in_->read_scanlines(0, 0, begin, end, spec_.z, 0, 3, OIIO::TypeDesc::FLOAT, rgb);
      if (is_read) return "";
      const std::string problem = in_->geterror();
      return problem.empty() ? "its format's reader failed without a word" : problem;
    } catch (const std::exception& e) {
      return e.what();
    }
  }

 private:
  std::unique_ptr<OIIO::ImageInput> in_;
  OIIO::ImageSpec spec_;
};

/// Tries the format that the name suggests, then all others.
std::unique_ptr<OIIO::ImageInput> open_any(const std::string& path, const std::string& name,
                                           std::string& problem) {
  if (auto in = OIIO::ImageInput::create(name)) {
    OIIO::ImageSpec spec;
    if (in->open(path, spec)) return in;
    problem = in->geterror();
  }
  OIIO::geterror();
  auto in = OIIO::ImageInput::open(path);
  if (!in && problem.empty()) problem = OIIO::geterror();
  return in;
}

}  // namespace
}  // namespace rayfarm

extern "C" rayfarm::OpenImageFunction rayfarm_open_image;

rayfarm::OpenedImage rayfarm_open_image(int descriptor, const std::string& name, uint64_t most_pixels) {
  constexpr uint64_t kMostBytesPerPixel = 16;
  OIIO::attribute("limits:imagesize_MB",
                  static_cast<int>(std::max<uint64_t>(1, most_pixels * kMostBytesPerPixel >> 20)));
  std::string problem;
  try {
    const std::string opened = "/proc/self/fd/" + std::to_string(descriptor);
    auto in = rayfarm::open_any(opened, name, problem);
    if (const size_t at = problem.find(opened); at != std::string::npos)
      problem.replace(at, opened.size(), name);  // what the user calls it
    if (!in) return {nullptr, problem.empty() ? "it is no image" : problem};
    const int channels = in->spec().nchannels;
    if (channels < 3)
      return {nullptr, "it has " + std::to_string(channels) + " channels; red, green and blue are needed"};
    return {std::make_unique<rayfarm::OiioSource>(std::move(in)), ""};
  } catch (const std::exception& e) {
    return {nullptr, e.what()};
  }
}
