#include "common/compile/media.h"

namespace rayfarm {
namespace {

/// The most that the density can be in each block, which is that of its own cells and their neighbours.
void add_majorants(GrowingArray<float>& majorants, const ParticipatingMedium& medium,
                   std::span<const float> densities) {
  const auto blocks = medium.blocks();
  const auto range = [&](uint32_t block, size_t axis) {
    const uint32_t first = block * kMajorantCells;
    return std::array{first == 0 ? 0 : first - 1, std::min(first + kMajorantCells + 1, medium.cells[axis])};
  };
  for (uint32_t bz = 0; bz < blocks[2]; ++bz)
    for (uint32_t by = 0; by < blocks[1]; ++by)
      for (uint32_t bx = 0; bx < blocks[0]; ++bx) {
        const auto x = range(bx, 0), y = range(by, 1), z = range(bz, 2);
        float most = 0;
        for (size_t k = z[0]; k < z[1]; ++k)
          for (size_t j = y[0]; j < y[1]; ++j) {
            const float* const row = &densities[(k * medium.cells[1] + j) * medium.cells[0]];
            most = std::max(most, *std::max_element(row + x[0], row + x[1]));
          }
        majorants.push_back(most);
      }
}

}  // namespace

void add_media(SceneArrays<GrowingArray>& arrays, const SceneDescription& description) {
  for (const MediumDescription& described : description.media) {
    ParticipatingMedium& medium = arrays.media.emplace_back(described);
    if (!medium.has_grid()) continue;
    medium.first_density = static_cast<uint32_t>(arrays.medium_densities.size());
    medium.first_majorant = static_cast<uint32_t>(arrays.medium_majorants.size());
    arrays.medium_densities.insert(arrays.medium_densities.end(), described.densities.begin(),
                                   described.densities.end());
    add_majorants(arrays.medium_majorants, medium, described.densities);
  }
}

}  // namespace rayfarm
