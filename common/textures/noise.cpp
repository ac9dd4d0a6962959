#include "common/textures/noise.h"

#include "common/sampling/random.h"

namespace rayfarm {
namespace {

uint64_t hash_cell(const Vec3& cell, uint32_t seed) {
  // Far from the origin cells repeat, which no one sees.
  const auto whole = [](double x) {
    return static_cast<uint64_t>(static_cast<int64_t>(std::clamp(x, -1e15, 1e15)));
  };
  return mix_bits(whole(cell.x) ^ mix_bits(whole(cell.y) ^ mix_bits(whole(cell.z) ^ mix_bits(seed))));
}

/// The slope at a lattice point, one of the twelve towards the edges of a cube, times the distance from it.
double slope(const Vec3& cell, const Vec3& from, uint32_t seed) {
  const auto h = static_cast<uint32_t>(hash_cell(cell, seed) % 12);
  const double a = h & 1 ? 1 : -1, b = h & 2 ? 1 : -1;
  return h < 4 ? a * from.x + b * from.y : h < 8 ? a * from.x + b * from.z : a * from.y + b * from.z;
}

double fade(double t) {
  return t * t * t * (t * (t * 6 - 15) + 10);
}

}  // namespace

double solid_noise(const Vec3& p, uint32_t seed) {
  const Vec3 cell = glm::floor(p), f = p - cell;
  const Vec3 w(fade(f.x), fade(f.y), fade(f.z));
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 at(corner & 1, corner >> 1 & 1, corner >> 2);
    const double weight =
        (at.x > 0 ? w.x : 1 - w.x) * (at.y > 0 ? w.y : 1 - w.y) * (at.z > 0 ? w.z : 1 - w.z);
    sum += weight * slope(cell + at, f - at, seed);
  }
  return sum;
}

double turbulence(const Vec3& p, uint32_t octaves, uint32_t seed, double width) {
  double sum = 0, size = 1;
  for (uint32_t i = 0; i < octaves; ++i, size /= 2) {
    const double kept =
        std::clamp(2 - 2 * width / size, 0.0, 1.0);  // an octave narrower than the ray averages out
    if (kept == 0) break;
    sum += kept * size * solid_noise(p / size, seed + i);
  }
  return sum;
}

double cell_number(const Vec3& cell, uint32_t seed) {
  return static_cast<double>(hash_cell(cell, seed) >> 11) * 0x1p-53;
}

}  // namespace rayfarm
