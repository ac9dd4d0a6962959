#pragma once
// Arrays of values in space as textures (thesis 2.3.6): one value for each cell, or one for each of the three
// primary colours.
#include <array>
#include <vector>

#include "common/errors/stop.h"
#include "common/textures/texture.h"

namespace rayfarm {

struct ArrayValues {
  std::array<uint32_t, 3> size{0, 0, 0};
  uint32_t channels = 1;      ///< or 3
  std::vector<float> values;  ///< by cells, x fastest; the channels of a cell together

  uint64_t cells() const { return uint64_t{size[0]} * size[1] * size[2]; }
};

/// The array and its mip map: levels of half the cells each way, each cell the mean of those that it covers.
/// Three halves a cell; sets the texture's size and levels. Throws Stopped.
std::vector<uint16_t> make_array_texels(const ArrayValues& array, Texture& texture,
                                        const std::stop_token& stop);

/// Values at `p`, in cells of the largest level, between the two levels whose cells are about as wide as what
/// the ray sees.
Color eval_array(const Texture& texture, std::span<const uint16_t> texels, const Vec3& p, double width);

}  // namespace rayfarm
