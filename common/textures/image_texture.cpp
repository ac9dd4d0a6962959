#include "common/textures/image_texture.h"

#include "common/image/half_float.h"
#include "common/image/pixel_format.h"
#include "common/textures/halving.h"

namespace rayfarm {
namespace {

/// A level of the mip map in the making. It takes the rows of the one above from the top, so that the largest
/// level need not be held.
class Level {
 public:
  Level(size_t above_columns, size_t above_rows)
      : across_(above_columns),
        down_(above_rows),
        columns(across_.count()),
        rows(down_.count()),
        pixels(columns * rows, Color(0)) {}

  void add(std::span<const Color> row) {
    for (size_t y = down_.first_with(above_row_); y <= down_.last_with(above_row_); ++y) {
      const double part = down_.share(y, above_row_);
      Color* const sums = &pixels[y * columns];
      for (size_t x = 0; x < columns; ++x)
        for (size_t u = across_.begin(x); u < across_.end(x); ++u)
          sums[x] += part * across_.share(x, u) * row[u];
    }
    ++above_row_;
  }

 private:
  Halving across_, down_;
  size_t above_row_ = 0;

 public:
  size_t columns, rows;
  std::vector<Color> pixels;
};

void append_halves(std::span<const Color> row, std::vector<uint16_t>& texels) {
  for (const Color& color : row)
    for (int c = 0; c < 3; ++c) texels.push_back(half_of_float(std::max(0.0, color[c])));  // no number: 0
}

}  // namespace

bool is_linear(const std::string& path, const ImageReading& reading) {
  using Encoding = ImageReading::Encoding;
  if (reading.part == ImagePart::alpha) return true;
  return reading.encoding == Encoding::usual ? holds_linear_light(path)
                                             : reading.encoding == Encoding::linear;
}

std::vector<uint16_t> load_texels(const ImageFile& file, Texture& texture, uint64_t most_pixels,
                                  const std::stop_token& stop, const ImageReading& reading) {
  ImageReader reader(file, most_pixels, reading.part);
  const bool keeps_values = is_linear(file.name, reading);
  const auto columns = static_cast<size_t>(reader.width_px()), rows = static_cast<size_t>(reader.height_px());
  texture.width_px = static_cast<uint32_t>(columns);
  texture.height_px = static_cast<uint32_t>(rows);
  texture.levels = 1;
  std::vector<uint16_t> texels;
  texels.reserve(4 * columns * rows);  // three each; the other levels of a square are a third of it
  std::vector<Color> row(columns);
  Level level(columns, rows);
  for (size_t y = 0; y < rows; ++y) {
    throw_if_stopped(stop);
    const std::span<const float> values = reader.next_row();
    for (size_t x = 0; x < columns; ++x)
      for (size_t c = 0; c < 3; ++c) {
        const double value = static_cast<double>(values[3 * x + c]);
        row[x][static_cast<int>(c)] = keeps_values ? value : decode_srgb(value);
      }
    append_halves(row, texels);
    level.add(row);
  }
  for (size_t w = columns, h = rows; w > 1 || h > 1;) {
    w = level.columns;
    h = level.rows;
    ++texture.levels;
    Level next(w, h);
    for (size_t y = 0; y < h; ++y) {
      throw_if_stopped(stop);
      const std::span<const Color> done = std::span(level.pixels).subspan(y * w, w);
      append_halves(done, texels);
      next.add(done);
    }
    level = std::move(next);
  }
  return texels;
}

}  // namespace rayfarm
