#include "common/textures/normal_map.h"

#include <algorithm>

#include "common/image/half_float.h"

namespace rayfarm {
namespace {

/// Of white over black, in widths of the image. Formats that give heights without a unit (MTL) leave it open.
constexpr double kHeight = 0.01;

Color texel_at(const std::vector<uint16_t>& texels, size_t texel) {
  return {float_of_half(texels[3 * texel]), float_of_half(texels[3 * texel + 1]),
          float_of_half(texels[3 * texel + 2])};
}

double mean_of(const Color& c) {
  return (c.x + c.y + c.z) / 3;
}

/// One level, whose rows begin at the top.
class Level {
 public:
  Level(std::vector<uint16_t>& texels, size_t first, size_t columns, size_t rows)
      : texels_(texels), first_(first), columns_(columns), rows_(rows) {}

  void make_normals() {
    const std::vector<double> top = heights(0);
    std::vector<double> above = heights(rows_ - 1), here = top;
    const double per_texel = 0.5 * kHeight * static_cast<double>(columns_);
    for (size_t y = 0; y < rows_; ++y) {
      const std::vector<double> below = y + 1 < rows_ ? heights(y + 1) : top;
      for (size_t x = 0; x < columns_; ++x) {
        const double right = here[(x + 1) % columns_], left = here[(x + columns_ - 1) % columns_];
        const Vec3 normal =
            normalized(Vec3(per_texel * (left - right), per_texel * (below[x] - above[x]), 1));
        for (size_t c = 0; c < 3; ++c)
          texels_[3 * (first_ + y * columns_ + x) + c] =
              half_of_float(0.5 + 0.5 * normal[static_cast<int>(c)]);
      }
      above = here;
      here = below;
    }
  }

 private:
  std::vector<double> heights(size_t y) const {
    std::vector<double> row(columns_);
    for (size_t x = 0; x < columns_; ++x) row[x] = mean_of(texel_at(texels_, first_ + y * columns_ + x));
    return row;
  }

  std::vector<uint16_t>& texels_;
  size_t first_, columns_, rows_;
};

}  // namespace

bool holds_normals(const Texture& image, const std::vector<uint16_t>& texels) {
  const Color mean = texel_at(texels, texel_count(image) - 1);
  constexpr double kLeastBlue = 0.65, kMostLean = 0.15;
  return mean.z > kLeastBlue && std::abs(mean.x - 0.5) < kMostLean && std::abs(mean.y - 0.5) < kMostLean;
}

void make_normals_of_heights(const Texture& image, std::vector<uint16_t>& texels) {
  size_t first = 0;
  for (uint32_t level = 0; level < image.levels; ++level) {
    const size_t columns = std::max(1u, image.width_px >> level),
                 rows = std::max(1u, image.height_px >> level);
    Level(texels, first, columns, rows).make_normals();
    first += columns * rows;
  }
}

}  // namespace rayfarm
