#pragma once
// Textures (thesis 2.3.6; Shirley, Sung and Brown 1991, section 2.1): a texture answers for a point in space
// and a pair (u, v), and uses what it needs of both. Plain data; the texels of images and arrays stand in the
// scene's arrays.
#include <array>
#include <cstdint>
#include <span>

#include "common/math/vector.h"

namespace rayfarm {

/// What of an image is seen outside of (u, v) from 0 to 1.
enum class TextureWrap : uint16_t {
  repeat,
  clamp,  ///< its outermost pixels go on
  mirror  ///< every second copy is mirrored
};

enum class TextureKind : uint32_t {
  checker,  ///< cubes of side 1
  noise,    ///< turbulence of `octaves`
  marble,   ///< waves along x, disturbed by turbulence
  wood,     ///< one tree about the y axis: rings of equal area
  boards,   ///< a floor of boards along x, `aspect` long and 1 wide, each with its own place in the tree
  bricks,   ///< a wall in x and y, `aspect` long and 1 high, each with its own tint; mortar `gap` wide
  fourier,  ///< a sum of `octaves` sines, each in a direction of its own (thesis 2.3.6)
  image,    ///< in (u, v)
  array     ///< values in space (thesis 2.3.6), from `first` for 0 to `second` for 1; each cell is 1 wide
};

inline constexpr std::array kTextureKindWords{"checker", "noise",   "marble", "wood", "boards",
                                              "bricks",  "fourier", "image",  "array"};

struct Texture {
  TextureKind kind = TextureKind::checker;
  uint32_t is_mapped = 0;  ///< 1: the pattern lies in (u, v, 0), not in space; images always do
  uint32_t octaves = 5, seed = 0;
  Color first{1}, second{0};
  Vec3 scale{1};   ///< lengths of one unit of the pattern
  Vec2 offset{0};  ///< of an image, added to (u, v) after scaling
  double strength = 1, aspect = 1, gap = 0;
  /// Of an image or array: halves of halves.
  uint32_t first_texel = 0, width_px = 0, height_px = 0, levels = 0;
  Vec3 from{0};                            ///< of an array: the corner of its first cell; else 0
  uint32_t depth_px = 0, is_repeated = 1;  ///< of an array; else its outermost values go on outside of it
  std::array<TextureWrap, 2> wraps{};      ///< of an image, along u and v
  uint32_t is_nearest = 0;                 ///< 1: an image's pixels are seen as squares where they are large
};

/// Of an image or array, at all its levels; else 0.
size_t texel_count(const Texture& texture);

struct TexturePoint {
  Vec3 p{0};  ///< in the object's space
  Vec2 uv{0};
  double width = 0, width_uv = 0;  ///< of what the ray sees, for filtering
};

/// The texture's colour: reflectance, linear Rec. 709. `texels`: of all images and arrays, three halves each.
Color eval_texture(const Texture& texture, std::span<const uint16_t> texels, const TexturePoint& at);

}  // namespace rayfarm
