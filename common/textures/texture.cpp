#include "common/textures/texture.h"

#include <numbers>

#include "common/image/half_float.h"
#include "common/math/portable_math.h"
#include "common/textures/array_texture.h"
#include "common/textures/noise.h"

namespace rayfarm {
namespace {

Color between(const Texture& t, double part) {
  return t.first + std::clamp(part, 0.0, 1.0) * (t.second - t.first);
}

double fraction(double x) {
  return x - std::floor(x);
}

Color checker(const Texture& t, const Vec3& p, double width) {
  const Vec3 cell = glm::floor(p);
  const double sum = cell.x + cell.y + cell.z;
  const double part = sum - 2 * std::floor(sum / 2);
  // What a ray sees of many squares at once is their mean.
  return between(t, part + (0.5 - part) * smooth_step(0.7, 2, width));
}

Color marble(const Texture& t, const Vec3& p, double width) {
  const double wave = portable_sin(
      std::fmod(2 * std::numbers::pi * (p.x + t.strength * turbulence(p, t.octaves, t.seed, width)),
                2 * std::numbers::pi));
  return between(t, 0.5 + 0.5 * wave);
}

/// Light and dark rings about the y axis. The area between them is constant, so their radius grows with the
/// root of their number; they narrow a little with height and are no true circles.
double wood_rings(const Texture& t, const Vec3& p, double width) {
  const double taper = 1 + 0.02 * p.y;
  const double wobble = 0.15 * t.strength * turbulence(Vec3(p.x, 0.15 * p.y, p.z), t.octaves, t.seed, width);
  const double radius = std::max(0.0, std::sqrt(p.x * p.x + p.z * p.z) * taper + wobble);
  const double ring = fraction(radius * radius);
  const double seen = ring < 0.7 ? smooth_step(0, 0.7, ring) : 1 - smooth_step(0.7, 1, ring);
  return seen + (0.4 - seen) * smooth_step(0.3, 1, width * 2 * std::max(radius, 0.5));
}

/// Each board is cut from another place of the tree, which the noise at its corner chooses (Shirley, Sung and
/// Brown, Figure 1).
Color boards(const Texture& t, const Vec3& p, double width) {
  const double row = std::floor(p.z), offset = cell_number({row, 7, 0}, t.seed);
  const double along = p.x / t.aspect + offset, board = std::floor(along);
  const Vec3 corner(board, row, 0);
  const Vec3 place(2 + 6 * cell_number(corner, t.seed + 1), 40 * cell_number(corner, t.seed + 2),
                   8 * cell_number(corner, t.seed + 3) - 4);
  const Vec3 in_board(fraction(p.z), fraction(along) * t.aspect, p.y);
  const double tint = 0.85 + 0.15 * cell_number(corner, t.seed + 4);
  const double across = std::abs(in_board.x - 0.5), end = std::abs(fraction(along) - 0.5) * t.aspect;
  const double joint =
      std::max(smooth_step(0.5 - t.gap, 0.5, across), smooth_step(t.aspect / 2 - t.gap, t.aspect / 2, end));
  return between(t, wood_rings(t, place + in_board, width)) * tint * (1 - 0.8 * joint * (t.gap > 0 ? 1 : 0));
}

Color bricks(const Texture& t, const Vec3& p, double width) {
  const double row = std::floor(p.y), along = p.x / t.aspect + 0.5 * (row - 2 * std::floor(row / 2));
  const Vec3 corner(std::floor(along), row, 0);
  const double x = std::abs(fraction(along) - 0.5) * t.aspect, y = std::abs(fraction(p.y) - 0.5);
  const double edge = std::min(t.aspect / 2 - x, 0.5 - y);
  const double soft = std::max(width, 0.02);
  const double mortar = 1 - smooth_step(t.gap / 2 - soft / 2, t.gap / 2 + soft / 2, edge);
  const double tint = 1 - t.strength * (0.4 * cell_number(corner, t.seed) +
                                        0.15 * turbulence(4.0 * p, t.octaves, t.seed, 4 * width));
  return (1 - mortar) * std::max(tint, 0.0) * t.first + mortar * t.second;
}

double fourier(const Texture& t, const Vec3& p, double width) {
  double sum = 0, total = 0, frequency = 1;
  for (uint32_t i = 0; i < t.octaves; ++i, frequency *= 1.6) {
    const Vec3 key(i, 0, 0);
    const Vec3 direction = normalized(
        Vec3(cell_number(key, t.seed), cell_number(key, t.seed + 1), cell_number(key, t.seed + 2)) - 0.5);
    const double amplitude = 1 / frequency,
                 phase = glm::dot(p, direction) * frequency + cell_number(key, t.seed + 3);
    const double kept = std::clamp(2 - 2 * width * frequency, 0.0, 1.0);
    sum += kept * amplitude * portable_sin(2 * std::numbers::pi * fraction(phase));
    total += amplitude;
  }
  return 0.5 + 0.5 * t.strength * sum / std::max(total, 1e-9);
}

/// A pixel's place among `n`, from any in the plane.
uint32_t wrapped(double i, uint32_t n, TextureWrap wrap) {
  if (wrap == TextureWrap::clamp) return static_cast<uint32_t>(std::clamp(i, 0.0, n - 1.0));
  const double copy = std::floor(i / n);
  const uint32_t place = std::min(static_cast<uint32_t>(i - n * copy), n - 1);
  const bool is_turned = wrap == TextureWrap::mirror && copy - 2 * std::floor(copy / 2) == 1;
  return is_turned ? n - 1 - place : place;
}

/// One level of an image, bilinearly or not at all.
Color image_level(const Texture& t, std::span<const uint16_t> texels, uint32_t level, const Vec2& uv) {
  size_t first = t.first_texel;
  uint32_t w = t.width_px, h = t.height_px;
  for (uint32_t i = 0; i < level; ++i) {
    first += size_t{w} * h;
    w = std::max(1u, w / 2);
    h = std::max(1u, h / 2);
  }
  const double x = uv.x * w - 0.5, y = (1 - uv.y) * h - 0.5;  // images begin at the top
  const double fx = std::floor(x), fy = std::floor(y);
  const auto texel = [&](double i, double k) {
    const size_t at = 3 * (first + size_t{wrapped(k, h, t.wraps[1])} * w + wrapped(i, w, t.wraps[0]));
    return Color(float_of_half(texels[at]), float_of_half(texels[at + 1]), float_of_half(texels[at + 2]));
  };
  if (t.is_nearest && level == 0) return texel(std::floor(x + 0.5), std::floor(y + 0.5));
  const double a = x - fx, b = y - fy;
  return (1 - b) * ((1 - a) * texel(fx, fy) + a * texel(fx + 1, fy)) +
         b * ((1 - a) * texel(fx, fy + 1) + a * texel(fx + 1, fy + 1));
}

/// Between the two levels whose texels are about as wide as what the ray sees (Williams 1983).
Color image(const Texture& t, std::span<const uint16_t> texels, const Vec2& uv, double width_uv) {
  // Of mirrored copies two make a period; what is clamped may be far off, or no number.
  const auto place_of = [&t](double x, size_t axis) {
    switch (t.wraps[axis]) {
      case TextureWrap::clamp:
        return x >= -1 && x <= 2 ? x : x > 0 ? 2.0 : -1.0;
      case TextureWrap::mirror:
        return 2 * fraction(x / 2);
      case TextureWrap::repeat:
        break;
    }
    return fraction(x);
  };
  const Vec2 place(place_of(uv.x, 0), place_of(uv.y, 1));
  const double wide = std::max(1.0, width_uv * std::max(t.width_px, t.height_px));
  // In this order: what is no number chooses the smallest level.
  const double level = std::min(static_cast<double>(t.levels - 1), portable_log(wide) / std::numbers::ln2);
  const auto below = static_cast<uint32_t>(level);
  const double part = level - below;
  const Color fine = image_level(t, texels, below, place);
  return part > 0 ? (1 - part) * fine + part * image_level(t, texels, below + 1, place) : fine;
}

}  // namespace

size_t texel_count(const Texture& t) {
  if (t.kind < TextureKind::image) return 0;
  const uint32_t depth_px = t.kind == TextureKind::array ? t.depth_px : 1;
  size_t count = 0;
  for (uint32_t level = 0; level < t.levels; ++level)
    count += size_t{std::max(1u, t.width_px >> level)} * std::max(1u, t.height_px >> level) *
             std::max(1u, depth_px >> level);
  return count;
}

Color eval_texture(const Texture& t, std::span<const uint16_t> texels, const TexturePoint& at) {
  if (t.kind == TextureKind::image)
    return image(t, texels, at.uv / Vec2(t.scale) + t.offset,
                 at.width_uv / std::min(std::abs(t.scale.x), std::abs(t.scale.y)));
  const Vec3 p = (t.is_mapped ? Vec3(at.uv, 0) : at.p) / t.scale;
  const double width = (t.is_mapped ? at.width_uv : at.width) / std::min({t.scale.x, t.scale.y, t.scale.z});
  switch (t.kind) {
    case TextureKind::checker:
      return checker(t, p, width);
    case TextureKind::noise:
      return between(t, 0.5 + 0.5 * t.strength * turbulence(p, t.octaves, t.seed, width));
    case TextureKind::marble:
      return marble(t, p, width);
    case TextureKind::wood:
      return between(t, wood_rings(t, p, width));
    case TextureKind::boards:
      return boards(t, p, width);
    case TextureKind::bricks:
      return bricks(t, p, width);
    case TextureKind::fourier:
      return between(t, fourier(t, p, width));
    case TextureKind::array:
      return t.first + eval_array(t, texels, p - t.from / t.scale, width) * (t.second - t.first);
    case TextureKind::image:
      break;
  }
  return Color(0);
}

}  // namespace rayfarm
