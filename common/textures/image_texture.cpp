#include "common/textures/image_texture.h"

#include "common/image/half_float.h"
#include "common/image/image_file.h"
#include "common/image/pixel_format.h"

namespace rayfarm {

std::vector<uint16_t> load_texels(const std::string& path, Texture& texture) {
  const ReadImage image = read_image(path);
  const std::string extension = extension_of(path);
  const bool is_linear = extension == ".exr" || extension == ".hdr" || extension == ".pfm";
  const auto columns = static_cast<size_t>(image.width_px), rows = static_cast<size_t>(image.height_px);
  std::vector<Color> level(columns * rows);
  for (size_t i = 0; i < level.size(); ++i)
    for (size_t c = 0; c < 3; ++c) {
      const double value = static_cast<double>(image.pixels[3 * i + c]);
      level[i][static_cast<int>(c)] = is_linear ? value : decode_srgb(value);
    }
  texture.width_px = static_cast<uint32_t>(columns);
  texture.height_px = static_cast<uint32_t>(rows);
  texture.levels = 0;
  std::vector<uint16_t> texels;
  for (size_t w = columns, h = rows;;) {
    for (const Color& color : level)
      for (int c = 0; c < 3; ++c) texels.push_back(half_of_float(std::max(color[c], 0.0)));
    ++texture.levels;
    if (w == 1 && h == 1) break;
    const size_t next_w = std::max<size_t>(1, w / 2), next_h = std::max<size_t>(1, h / 2);
    std::vector<Color> next(next_w * next_h);
    for (size_t y = 0; y < next_h; ++y)
      for (size_t x = 0; x < next_w; ++x) {
        // All texels that this one covers, two or three each way.
        Color sum(0);
        double count = 0;
        for (size_t v = y * h / next_h; v < (y + 1) * h / next_h; ++v)
          for (size_t u = x * w / next_w; u < (x + 1) * w / next_w; ++u, ++count) sum += level[v * w + u];
        next[y * next_w + x] = sum / count;
      }
    level = std::move(next);
    w = next_w;
    h = next_h;
  }
  return texels;
}

}  // namespace rayfarm
