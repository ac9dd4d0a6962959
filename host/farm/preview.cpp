#include "host/farm/preview.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <stdexcept>

#include "common/errors/input_error.h"
#include "common/image/colour_channels.h"
#include "common/image/image_file.h"
#include "common/image/image_writer.h"

namespace rayfarm {
namespace {

/// Larger pictures are shown by every other pixel, or fewer.
constexpr int kLongestSide_px = 4096;
/// Of the chequer that stands for what is not there.
constexpr int kChequer_px = 16;
constexpr std::array<uint8_t, 2> kChequerGreys{96, 160};
/// The attribute by which such pictures are known.
constexpr const char* kMark = "rayfarm/partial";

}  // namespace

std::string preview_of(const std::string& file) {
  const std::filesystem::path path(file);
  return (path.parent_path() / (path.stem().string() + ".partial.png")).string();
}

bool is_preview(const std::string& path) {
  try {
    return read_image_info(path).attributes.contains(kMark);
  } catch (const IoError&) {
    return false;
  }
}

void write_preview(const std::string& path, const Image& image, const FrameBuffer& buffer) {
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored) && !is_preview(path))
    throw std::runtime_error(path + " is another picture");
  const PixelRect& window = image.window;
  const SubpolygonGrid& grid = buffer.grid();
  const int step = (std::max(window.width(), window.height()) + kLongestSide_px - 1) / kLongestSide_px;
  const std::array<PixelChannel, 3> channels = colour_channels(image.layout);
  Image preview;
  preview.width_px = (window.width() + step - 1) / step;
  preview.height_px = (window.height() + step - 1) / step;
  preview.window = {0, 0, preview.width_px, preview.height_px};
  preview.layout = make_pixel_layout(PixelFormat::rgb8);
  ImageWriter writer(path, preview, {{"rayfarm/version", RAYFARM_VERSION}, {kMark, "yes"}});
  std::vector<std::byte> row(3 * static_cast<size_t>(preview.width_px));
  int grid_row = 0;
  for (int y = 0; y < preview.height_px; ++y) {
    while (grid.polygon(grid.first_of_row(grid_row)).bottom - window.y0 < y * step) ++grid_row;
    // Subpolygon by subpolygon: which one a pixel belongs to need not be asked pixel by pixel.
    for (SubpolygonId i = grid.first_of_row(grid_row); i < grid.first_of_row(grid_row + 1); ++i) {
      const DisplayPolygon p = grid.polygon(i);
      for (int x = (p.left - window.x0 + step - 1) / step; x * step <= p.right - window.x0; ++x) {
        const std::byte* from =
            buffer.is_there(i) ? buffer.pixel(window.x0 + x * step, window.y0 + y * step) : nullptr;
        for (size_t c = 0; c < 3; ++c)
          row[3 * static_cast<size_t>(x) + c] = static_cast<std::byte>(
              from ? encode_srgb8(decode_value(channels[c], from))
                   : kChequerGreys[static_cast<size_t>((x / kChequer_px + y / kChequer_px) % 2)]);
      }
    }
    writer.write_rows(row);
  }
  writer.finish();
}

}  // namespace rayfarm
