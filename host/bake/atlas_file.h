#pragma once
// Zones as texels: an image with a rectangle for each primitive that has zones, and the list of them.
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "common/lighting/zones/baked_light.h"

namespace rayfarm {

/// Of a primitive: its front's cells, and to the right of them its back's.
struct AtlasRectangle {
  uint32_t grid = 0;                             ///< of the map
  uint32_t x = 0, y = 0, columns = 0, rows = 0;  ///< of one side, in texels; y from the top
};

struct AtlasLayout {
  std::vector<AtlasRectangle> rectangles;  ///< as the map's grids
  uint32_t width = 0, height = 0;
};

/// In shelves, the highest first. Throws std::runtime_error if there is no room in an image.
AtlasLayout lay_out_atlas(const ZoneMap& map);

/// Where a cell is in its side's texels. A triangle's cells are folded into a square: those that hang from a
/// row's upper line stand in its other half, turned by half a turn.
std::array<uint32_t, 2> texel_of(const ZoneMap& map, const ZoneGrid& grid, uint32_t cell);

/// Writes channels R, G, B (radiance) and `id` (1 + the rectangle's number; 0: no zone is there), all float.
/// `names`: of objects, by instance, and of materials. Throws IoError; the file appears when it is whole.
struct AtlasNames {
  std::vector<std::string> objects, materials;
};
void write_atlas(const std::string& path, const ZoneMap& map, const BakedLight& light,
                 const AtlasLayout& layout, const AtlasNames& names,
                 std::map<std::string, std::string> attributes);

}  // namespace rayfarm
