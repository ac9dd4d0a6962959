#include "common/textures/array_texture.h"

#include <algorithm>
#include <numbers>

#include "common/image/half_float.h"
#include "common/math/portable_math.h"
#include "common/textures/halving.h"

namespace rayfarm {
namespace {

using Size = std::array<uint32_t, 3>;

/// One level of the mip map.
struct Level {
  Size size;
  std::vector<glm::vec3> cells;

  const glm::vec3& at(size_t x, size_t y, size_t z) const { return cells[(z * size[1] + y) * size[0] + x]; }
};

Level halved(const Level& above, const std::stop_token& stop) {
  const Halving wide(above.size[0]), high(above.size[1]), deep(above.size[2]);
  Level level;
  for (size_t axis = 0; axis < 3; ++axis)
    level.size[axis] = static_cast<uint32_t>(Halving(above.size[axis]).count());
  level.cells.reserve(wide.count() * high.count() * deep.count());
  for (size_t z = 0; z < deep.count(); ++z)
    for (size_t y = 0; y < high.count(); ++y) {
      throw_if_stopped(stop);
      for (size_t x = 0; x < wide.count(); ++x) {
        Vec3 sum(0);
        for (size_t c = deep.begin(z); c < deep.end(z); ++c)
          for (size_t b = high.begin(y); b < high.end(y); ++b) {
            const double part = deep.share(z, c) * high.share(y, b);
            for (size_t a = wide.begin(x); a < wide.end(x); ++a)
              sum += part * wide.share(x, a) * Vec3(above.at(a, b, c));
          }
        level.cells.emplace_back(sum);
      }
    }
  return level;
}

void append_halves(const Level& level, std::vector<uint16_t>& texels) {
  for (const glm::vec3& cell : level.cells)
    for (int c = 0; c < 3; ++c) texels.push_back(half_of_float(static_cast<double>(cell[c])));
}

/// One level of an array, between its eight nearest cells. `p` in cells of the largest level.
Color array_level(const Texture& t, std::span<const uint16_t> texels, uint32_t level, const Vec3& p) {
  size_t first = t.first_texel;
  const std::array<uint32_t, 3> whole{t.width_px, t.height_px, t.depth_px};
  std::array<uint32_t, 3> size = whole;
  for (uint32_t i = 0; i < level; ++i) {
    first += size_t{size[0]} * size[1] * size[2];
    for (uint32_t& n : size) n = std::max(1u, n / 2);
  }
  std::array<std::array<size_t, 2>, 3> cells;  // along each axis the two about p
  Vec3 part;
  for (int axis = 0; axis < 3; ++axis) {
    const uint32_t n = size[static_cast<size_t>(axis)];
    const double x = p[axis] * n / whole[static_cast<size_t>(axis)] - 0.5, below = std::floor(x);
    part[axis] = x - below;
    for (const int k : {0, 1}) {
      const double i = below + k;
      const double inside = t.is_repeated ? i - n * std::floor(i / n) : std::max(i, 0.0);
      // In this order: what is no number is a cell, too.
      cells[static_cast<size_t>(axis)][static_cast<size_t>(k)] =
          static_cast<size_t>(std::max(0.0, std::min(n - 1.0, inside)));
    }
  }
  Color sum(0);
  for (size_t corner = 0; corner < 8; ++corner) {
    double weight = 1;
    std::array<size_t, 3> cell;
    for (size_t axis = 0; axis < 3; ++axis) {
      const size_t side = corner >> axis & 1;
      cell[axis] = cells[axis][side];
      const double above = part[static_cast<int>(axis)];
      weight *= side ? above : 1 - above;
    }
    const size_t at = 3 * (first + (cell[2] * size[1] + cell[1]) * size[0] + cell[0]);
    sum += weight *
           Color(float_of_half(texels[at]), float_of_half(texels[at + 1]), float_of_half(texels[at + 2]));
  }
  return sum;
}

}  // namespace

std::vector<uint16_t> make_array_texels(const ArrayValues& array, Texture& texture,
                                        const std::stop_token& stop) {
  texture.width_px = array.size[0];
  texture.height_px = array.size[1];
  texture.depth_px = array.size[2];
  texture.levels = 1;
  Level level{array.size, {}};
  level.cells.reserve(array.cells());
  for (size_t i = 0; i < array.values.size(); i += array.channels)
    level.cells.push_back(array.channels == 1
                              ? glm::vec3(array.values[i])
                              : glm::vec3(array.values[i], array.values[i + 1], array.values[i + 2]));
  std::vector<uint16_t> texels;
  texels.reserve(3 * array.cells());
  append_halves(level, texels);
  while (std::max({level.size[0], level.size[1], level.size[2]}) > 1) {
    level = halved(level, stop);
    append_halves(level, texels);
    ++texture.levels;
  }
  return texels;
}

Color eval_array(const Texture& t, std::span<const uint16_t> texels, const Vec3& p, double width) {
  const double level =
      std::min(static_cast<double>(t.levels - 1), portable_log(std::max(1.0, width)) / std::numbers::ln2);
  const auto below = static_cast<uint32_t>(level);
  const double part = level - below;
  const Color fine = array_level(t, texels, below, p);
  return part > 0 ? (1 - part) * fine + part * array_level(t, texels, below + 1, p) : fine;
}

}  // namespace rayfarm
