// image_writer FOLDER WIDTH HEIGHT [rgb8|half|float] [noise|smooth]: how fast pictures become files, made and
// written band by band, and the most memory that takes. Without the last two all are measured.
#include "common/image/image_writer.h"

#include <fmt/core.h>
#include <sys/resource.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <stdexcept>

namespace rayfarm {
namespace {

/// Made once, and written again and again: so that it is the writing that is measured.
constexpr int kBandRows = 64;

std::vector<std::byte> make_band(int width, const PixelLayout& layout, bool is_noise) {
  std::vector<std::byte> band(static_cast<size_t>(width) * kBandRows * layout.bytes);
  uint64_t state = 88172645463325252u;
  std::byte* out = band.data();
  for (int y = 0; y < kBandRows; ++y)
    for (int x = 0; x < width; ++x, out += layout.bytes) {
      std::array<double, 3> color{0.2 + 0.6 * x / width, 0.3 + 0.5 * y / kBandRows, 0.4 + 0.2 * x / width};
      if (is_noise)
        for (double& value : color) {
          state ^= state << 13, state ^= state >> 7, state ^= state << 17;  // Marsaglia 2003
          value = static_cast<double>(state >> 40) * 0x1p-24;
        }
      encode_values(layout.channels[0].format, color, out);
    }
  return band;
}

void measure(const std::filesystem::path& folder, int width, int height, const std::string& format,
             bool is_noise) {
  const PixelFormat of_pixels = format == "rgb8"   ? PixelFormat::rgb8
                                : format == "half" ? PixelFormat::half_float
                                                   : PixelFormat::float32;
  const Image image{width, height, {0, 0, width, height}, make_pixel_layout(of_pixels), {}};
  const std::vector<std::byte> band = make_band(width, image.layout, is_noise);
  const std::string path = folder / (format == "rgb8" ? "written.png" : "written.exr");
  const auto begin = std::chrono::steady_clock::now();
  ImageWriter writer(path, image, {}, {"rayfarm/rays"});
  for (int y = 0; y < height; y += kBandRows) {
    const auto rows = static_cast<size_t>(std::min(kBandRows, height - y));
    writer.write_rows(std::span(band).first(rows * static_cast<size_t>(width) * image.layout.bytes));
  }
  writer.finish({{"rayfarm/rays", "1"}});
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const double bytes = static_cast<double>(image.window.area()) * static_cast<double>(image.layout.bytes);
  fmt::print("{} × {} {} {}: {:.2f} s, {:.0f} MB/s of pixels, {} bytes of file, {} MiB at most until now\n",
             width, height, format, is_noise ? "noise" : "smooth", seconds, bytes / seconds / 1e6,
             std::filesystem::file_size(path), usage.ru_maxrss / 1024);
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace rayfarm

int main(int argc, char** argv) try {
  if (argc < 4)
    throw std::invalid_argument("image_writer FOLDER WIDTH HEIGHT [rgb8|half|float] [noise|smooth]");
  for (const std::string format : {"rgb8", "half", "float"})
    for (const std::string content : {"noise", "smooth"})
      if ((argc < 5 || format == argv[4]) && (argc < 6 || content == argv[5]))
        rayfarm::measure(argv[1], std::stoi(argv[2]), std::stoi(argv[3]), format, content == "noise");
  return 0;
} catch (const std::exception& e) {
  fmt::print(stderr, "{}\n", e.what());
  return 1;
}
