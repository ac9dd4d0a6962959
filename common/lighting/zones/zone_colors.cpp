#include "common/lighting/zones/zone_colors.h"

#include "common/lighting/textured.h"

namespace rayfarm {
namespace {

/// Points along each side of a cell.
constexpr uint32_t kPoints = 4;

}  // namespace

ZoneAlbedo albedo_of(const Material& m) {
  switch (m.kind) {
    case MaterialKind::classical:
    case MaterialKind::principled:
      return {{m.diffuse * m.color, m.diffuse * m.color}, Color(0)};
    case MaterialKind::lambertian:
    case MaterialKind::luminaire:
    case MaterialKind::polished:
      return {{m.color, m.color}, Color(0)};
    case MaterialKind::translucent:
      return {{m.color, m.back}, m.through};
    case MaterialKind::conductor:
    case MaterialKind::dielectric:
    case MaterialKind::mix:  // as its part where it is met
      break;
  }
  return {};
}

ZoneColors::ZoneColors(const Scene& scene, const ZoneMap& map)
    : grids_(map.grids()), first_of_grid_(grids_.size(), kNone) {
  for (const Material& material : scene.materials) of_material_.push_back(albedo_of(material));
  for (size_t i = 0; i < grids_.size(); ++i) {
    const ZoneGrid& grid = grids_[i];
    if (!grid.store.is_diffuse || !rayfarm::is_textured(scene.materials[grid.material])) continue;
    first_of_grid_[i] = static_cast<uint32_t>(of_cell_.size());
    for (uint32_t cell = 0; cell < grid.cell_count; ++cell) {
      ZoneAlbedo& mean = of_cell_.emplace_back();
      const double area = map.area(grid, cell);
      if (!(area > 0)) continue;
      const double width = std::sqrt(area) / kPoints;
      for (uint32_t k = 0; k < kPoints * kPoints; ++k) {
        const Vec2 u((k % kPoints + 0.5) / kPoints, (k / kPoints + 0.5) / kPoints);
        const ZonePoint point = map.point(grid, cell, 0, u, [&](uint32_t) { return u; });
        Surface surface = point.surface;
        const Ray ray{surface.p, -surface.geometric_normal};
        // Of a mix parts are met in turn, in an order that doesn't follow the places.
        const double choice = (k * 7 % (kPoints * kPoints) + 0.5) / (kPoints * kPoints);
        const ZoneAlbedo there =
            albedo_of(textured(scene, map.pose(), ray, point.hit, width, choice, surface));
        for (size_t side = 0; side < 2; ++side)
          mean.reflected[side] += there.reflected[side] / double{kPoints * kPoints};
        mean.through += there.through / double{kPoints * kPoints};
      }
    }
  }
}

}  // namespace rayfarm
