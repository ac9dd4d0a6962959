#include "common/lighting/zones/baked_light.h"

#include <numbers>

#include "common/lighting/light_sampling.h"
#include "common/lighting/zones/lit_surface.h"

namespace rayfarm {
namespace {

/// Parts of a mix are met in turn at so many looks.
constexpr uint32_t kLooks = 4;

/// Of what is kept under a polish, the part that is seen along the normal.
double seen_through_polish(const ZoneMap& map, const Scene& scene, const ZonePoint& point) {
  const Material& material = scene.materials[point.surface.material];
  if (!may_be_polished(material)) return 1;
  double sum = 0;
  for (uint32_t i = 0; i < kLooks; ++i)
    sum += passed_by_polish(
        look_at(scene, map, point.surface, point.hit, point.surface.geometric_normal, (i + 0.5) / kLooks));
  return sum / kLooks;
}

}  // namespace

BakedLight::BakedLight(const ZoneScene& zones, std::span<const ZonePassSolution> passes)
    : map_(zones.map()),
      values_(2 * map_.cell_count(), glm::vec3(0)),
      corners_(map_, [](const ZoneGrid& grid) { return grid.store.is_any(); }) {
  for (size_t pass = 0; pass < passes.size(); ++pass) add_pass(zones, pass, passes[pass]);
  corners_.set(
      [this](const ZoneGrid& grid, uint32_t cell, uint32_t side) { return of_cell(grid, cell, side); });
}

void BakedLight::add_pass(const ZoneScene& zones, size_t pass, const ZonePassSolution& solution) {
  const Scene& scene = zones.scene(pass);
  const ColourPass& colours = zones.colours(pass);
  for (const ZoneGrid& grid : map_.grids()) {
    if (!grid.store.is_any()) continue;
    const Material& material = scene.materials[grid.material];
    for (uint32_t cell = 0; cell < grid.cell_count; ++cell) {
      const double area = map_.area(grid, cell);
      if (!(area > 0)) continue;
      for (uint32_t side = 0; side < 2; ++side) {
        const ZonePoint middle = map_.point(grid, cell, side, Vec2(0.5), [](uint32_t) { return Vec2(0.5); });
        const uint64_t first = grid.slot(cell, side);
        Color power =
            solution.quantum.value(solution.total.at(first)) * seen_through_polish(map_, scene, middle);
        for (uint64_t slot = first + 1; slot < first + grid.store.slots(); ++slot)
          power += solution.quantum.value(solution.total.at(slot));
        Color radiance = power / (std::numbers::pi * area);
        if (is_luminaire(material)) {
          const Vec3& n = middle.surface.geometric_normal;
          radiance += emission_at(scene, map_.pose(), grid.instance, material, {n, n, side == 0, 1});
        }
        if (!colours.is_rgb) radiance = colours.rgb_from_channels * radiance;
        values_[2 * (size_t{grid.first_cell} + cell) + side] += glm::vec3(radiance);
      }
    }
  }
}

bool BakedLight::is_lit(const ZoneGrid& grid, uint32_t side) const {
  for (uint32_t cell = 0; cell < grid.cell_count; ++cell)
    if (of_cell(grid, cell, side) != Color(0)) return true;
  return false;
}

bool is_clear(const Scene& scene, const Material& material) {
  if (material.kind == MaterialKind::mix)
    return is_clear(scene, scene.materials[material.parts[0]]) ||
           is_clear(scene, scene.materials[material.parts[1]]);
  Lobes lobes;
  scatter(material, {Vec3(0, 0, 1), Vec3(0, 0, 1), true, material.index}, lobes);
  for (const Lobe& lobe : lobes)
    if (lobe.is_transmitted && lobe.spread != Lobe::Spread::diffuse && lobe.attenuation != Color(0))
      return true;
  return false;
}

}  // namespace rayfarm
