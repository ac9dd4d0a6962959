#pragma once
// What becomes of light that meets a surface with zones: parts that the zone keeps, and lobes that go on as
// rays, along mirrors and through glass.
#include "common/lighting/zones/zone_colors.h"
#include "common/lighting/zones/zone_directions.h"

namespace rayfarm {

/// Rays that a kept lobe that isn't diffuse sends into the cells of directions for each ray that comes in.
inline constexpr uint32_t kSpreadRays = 4;

/// A part of the light that comes in.
struct KeptPart {
  uint64_t slot = 0;
  Color fraction{0};
};
using KeptParts = InlineVector<KeptPart, 2 + 4 * kSpreadRays>;

/// True if zones of this grid keep what the lobe spreads.
inline bool is_kept(const ZoneGrid& grid, const Lobe& lobe) {
  if (lobe.spread == Lobe::Spread::diffuse) return grid.store.is_diffuse;
  return lobe.spread == Lobe::Spread::glossy && grid.store.direction_cells > 0 &&
         direction_cells_for(lobe.exponent) > 0;
}

/// The cell of directions, from 1 on, of a place in [0, 1]².
inline uint32_t direction_slot(const ZoneStore& store, const Vec2& place) {
  const auto cell = [&](double x) {
    return std::min(static_cast<uint32_t>(x * store.direction_cells), store.direction_cells - 1);
  };
  return 1 + cell(place.y) * store.direction_cells + cell(place.x);
}

/// Sets `parts` for light that comes from at.to_viewer. `point(i)`: pairs of random numbers, kSpreadRays for
/// each of four lobes. `tangent`: ZoneMap's there.
template <typename Point>
void find_kept(const ZoneGrid& grid, uint32_t cell, const ZoneAlbedo& albedo, const Surface& surface,
               const Interaction& at, const Lobes& lobes, const Vec3& tangent, Point point,
               KeptParts& parts) {
  parts.clear();
  const uint32_t side = surface.is_front ? 0 : 1;
  if (grid.store.is_diffuse) {
    if (albedo.reflected[side] != Color(0)) parts.push_back({grid.slot(cell, side), albedo.reflected[side]});
    if (albedo.through != Color(0)) parts.push_back({grid.slot(cell, 1 - side), albedo.through});
  }
  if (grid.store.direction_cells == 0) return;
  for (uint32_t l = 0; l < lobes.size(); ++l) {
    const Lobe& lobe = lobes[l];
    if (lobe.spread == Lobe::Spread::diffuse || !is_kept(grid, lobe)) continue;
    const Vec3 normal = lobe.is_transmitted ? -surface.geometric_normal : surface.geometric_normal;
    const Vec3 across = normalized(tangent - glm::dot(tangent, normal) * normal);
    const DirectionFrame frame(normal, across);
    Lobes alone;
    alone.push_back(lobe);
    for (uint32_t i = 0; i < kSpreadRays; ++i) {
      const ScatteredRay ray = sample(alone, at, point(l * kSpreadRays + i), 0);
      const Vec3 local = frame.to_local(ray.direction);
      if (ray.weight == Color(0) || !(local.z > 0)) continue;
      parts.push_back({grid.slot(cell, lobe.is_transmitted ? 1 - side : side) +
                           direction_slot(grid.store, direction_place(local)),
                       ray.weight / double{kSpreadRays}});
    }
  }
}

}  // namespace rayfarm
