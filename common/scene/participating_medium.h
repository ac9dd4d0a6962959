#pragma once
// Media that fill boxes of the world, and weaken and scatter the light on its way: smoke, dust, fog. Plain
// data. (What a ray is inside of, glass or water, is `Media` in common/lighting/media.h.)
#include <array>

#include "common/math/box.h"

namespace rayfarm {

/// A density is weighed between the centres of cells, so what is most of it in a block of this many cells
/// along each axis is most of one more cell on every side, too.
inline constexpr uint32_t kMajorantCells = 8;

struct ParticipatingMedium {
  Box box;                                 ///< in the world
  Color absorption{0}, scattering{0};      ///< per unit of length, where the density is 1
  double asymmetry = 0;                    ///< Henyey and Greenstein's g, the mean cosine: -1 < g < 1
  std::array<uint32_t, 3> cells{0, 0, 0};  ///< of the density's grid, along x, y, z; 0: the density is 1
  uint32_t first_density = 0;              ///< in medium_densities, x fastest
  uint32_t first_majorant = 0;             ///< in medium_majorants, x fastest: the most of each block
  uint32_t padding = 0;

  Color extinction() const { return absorption + scattering; }
  bool has_grid() const { return cells[0] > 0; }
  size_t cell_count() const { return size_t{cells[0]} * cells[1] * cells[2]; }
  /// How many blocks of cells have a majorant along each axis.
  std::array<uint32_t, 3> blocks() const {
    const auto of = [](uint32_t n) { return (n + kMajorantCells - 1) / kMajorantCells; };
    return {of(cells[0]), of(cells[1]), of(cells[2])};
  }
  size_t block_count() const {
    const auto n = blocks();
    return size_t{n[0]} * n[1] * n[2];
  }
};

/// Of a scene.
inline constexpr size_t kMostMedia = 64;

/// In a box through which light is weakened more than this many times by e, steps of random walks could take
/// for ever.
inline constexpr double kMostOpticalDepth = 1e6;

/// How many times light is weakened by e at most, across the box where its density is `most`.
inline double greatest_optical_depth(const ParticipatingMedium& medium, double most) {
  return max_component(medium.extinction()) * most * glm::length(medium.box.extent());
}

}  // namespace rayfarm
