#pragma once
// What zones reflect diffusely of the light that they get. "If the zone is textured, its average reflection
// properties must be found" (Shirley, Sung and Brown 1991, section 3): by points all over it.
#include <vector>

#include "common/lighting/zones/zone_map.h"

namespace rayfarm {

/// The parts that leave diffusely of light that comes to the front (0) and the back (1). A polish takes its
/// share by the direction in which light leaves.
struct ZoneAlbedo {
  std::array<Color, 2> reflected{Color(0), Color(0)};
  Color through{0};
};

ZoneAlbedo albedo_of(const Material& material);

class ZoneColors {
 public:
  /// `scene`: of a colour pass, the map's but for colours.
  ZoneColors(const Scene& scene, const ZoneMap& map);

  const ZoneAlbedo& operator()(const ZoneGrid& grid, uint32_t cell) const {
    const uint32_t first = first_of_grid_[static_cast<size_t>(&grid - grids_.data())];
    return first == kNone ? of_material_[grid.material] : of_cell_[first + cell];
  }
  /// True if the cells of a grid differ: what is kept of them is their light without their colour.
  bool is_textured(const ZoneGrid& grid) const {
    return first_of_grid_[static_cast<size_t>(&grid - grids_.data())] != kNone;
  }

 private:
  std::span<const ZoneGrid> grids_;
  std::vector<ZoneAlbedo> of_material_, of_cell_;
  std::vector<uint32_t> first_of_grid_;
};

}  // namespace rayfarm
