#include "common/image/formats/image_formats.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <exception>

namespace rayfarm {
namespace {

class OiioSource : public ImageSource {
 public:
  OiioSource(std::unique_ptr<OIIO::ImageInput> in, ImagePart part) : in_(std::move(in)), spec_(in_->spec()) {
    if (part == ImagePart::alpha) {
      first_ = spec_.alpha_channel;
      channels_ = 1;
    } else if (spec_.nchannels < 3) {
      channels_ = 1;
    }
    constexpr int kScanlines = 32;
    has_alpha = spec_.alpha_channel >= 0;
    width_px = spec_.width;
    height_px = spec_.height;
    rows_at_once = spec_.tile_width > 0 ? std::max(1, spec_.tile_height) : std::min(height_px, kScanlines);
  }
  std::string read_rows(int y, int count, float* rgb) override {
    const int first = first_, end_channel = first_ + channels_;
    const int begin = spec_.y + y, end = begin + count;
    try {
      const bool is_read = spec_.tile_width > 0
                               ? in_->read_tiles(0, 0, spec_.x, spec_.x + spec_.width, begin, end, spec_.z,
                                                 spec_.z + 1, first, end_channel, OIIO::TypeDesc::FLOAT, rgb)
                               : in_->read_scanlines(0, 0, begin, end, spec_.z, first, end_channel,
                                                     OIIO::TypeDesc::FLOAT, rgb);
      if (is_read) {
        if (channels_ == 1)
          for (size_t i = static_cast<size_t>(count) * static_cast<size_t>(width_px); i-- > 0;)
            rgb[3 * i] = rgb[3 * i + 1] = rgb[3 * i + 2] = rgb[i];
        return "";
      }
      const std::string problem = in_->geterror();
      return problem.empty() ? "its format's reader failed without a word" : problem;
    } catch (const std::exception& e) {
      return e.what();
    }
  }

 private:
  std::unique_ptr<OIIO::ImageInput> in_;
  OIIO::ImageSpec spec_;
  int first_ = 0, channels_ = 3;
};

/// Colours that are not multiplied by alpha.
OIIO::ImageSpec as_it_stands() {
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);
  return config;
}

/// Tries the format that the name suggests, then all others.
std::unique_ptr<OIIO::ImageInput> open_any(const std::string& path, const std::string& name,
                                           std::string& problem) {
  if (auto in = OIIO::ImageInput::create(name)) {
    OIIO::ImageSpec spec;
    if (in->open(path, spec, as_it_stands())) return in;
    problem = in->geterror();
  }
  OIIO::geterror();
  const OIIO::ImageSpec config = as_it_stands();
  auto in = OIIO::ImageInput::open(path, &config);
  if (!in && problem.empty()) problem = OIIO::geterror();
  return in;
}

}  // namespace
}  // namespace rayfarm

extern "C" rayfarm::OpenImageFunction rayfarm_open_image;

rayfarm::OpenedImage rayfarm_open_image(int descriptor, const std::string& name, uint64_t most_pixels,
                                        rayfarm::ImagePart part) {
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
    if (in->spec().nchannels < 1) return {nullptr, "it has no channels"};
    if (part == rayfarm::ImagePart::alpha && in->spec().alpha_channel < 0)
      return {nullptr, "it has no alpha channel"};
    return {std::make_unique<rayfarm::OiioSource>(std::move(in), part), ""};
  } catch (const std::exception& e) {
    return {nullptr, e.what()};
  }
}
