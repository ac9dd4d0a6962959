#pragma once
// Solid noise (Perlin 1985, 2002): smooth, band limited, about -1 to 1, zero at the lattice's points.
#include <cstdint>

#include "common/math/vector.h"

namespace rayfarm {

double solid_noise(const Vec3& p, uint32_t seed);
/// A sum of octaves, each half as large and half as wide. `width`: what is narrower is left out.
double turbulence(const Vec3& p, uint32_t octaves, uint32_t seed, double width);
/// A number in [0, 1) for a cell of the lattice.
double cell_number(const Vec3& cell, uint32_t seed);

}  // namespace rayfarm
