#pragma once
// The surface of a grid of zones as triangles, for what knows nothing else.
#include "common/lighting/zones/zone_map.h"

namespace rayfarm {

struct ZoneMesh {
  struct Vertex {
    Vec3 p{0};  ///< in the world
    GridPlace place{0};
  };
  std::vector<Vertex> vertices;
  std::vector<std::array<uint32_t, 3>> triangles;  ///< counter-clockwise as the front is seen
};

/// Plane grids keep their cells and area. Round ones have vertices between their zones' corners too, so that
/// neighbouring facets differ by no more than kFacetTurn, and what their planes cut off is cut off.
ZoneMesh mesh_of(const ZoneMap& map, const ZoneGrid& grid);

inline constexpr double kFacetTurn = 7.5 / 180 * 3.141592653589793;  ///< in radians

}  // namespace rayfarm
