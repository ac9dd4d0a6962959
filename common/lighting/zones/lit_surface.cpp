#include "common/lighting/zones/lit_surface.h"

#include "common/lighting/textured.h"
#include "common/materials/fresnel.h"

namespace rayfarm {

ZonePoint sample_zone(const ZoneMap& map, const Sampler& sampler, uint64_t seed, const ZoneGrid& grid,
                      uint32_t cell, uint32_t side, const SampleId& id) {
  return map.point(grid, cell, side, sampler.point(id, kOnZone), [&](uint32_t i) {
    const auto r = random_pair(seed, sampler.frame(), id, dimension::of_mix(i + 1));
    return Vec2(r[0], r[1]);
  });
}

LitSurface look_at(const Scene& scene, const ZoneMap& map, const Surface& surface, const Hit& hit,
                   const Vec3& to_viewer, double choice) {
  LitSurface lit{surface, scene.materials[surface.material], {}, {}};
  if (is_textured(lit.material))
    lit.material =
        textured(scene, map.pose(), {surface.p, -to_viewer}, hit, map.size() / 4, choice, lit.surface);
  lit.at = interaction_at(lit.surface, -to_viewer, lit.material);
  scatter(lit.material, lit.at, lit.lobes);
  return lit;
}

double passed_by_polish(const LitSurface& lit) {
  if (lit.material.kind != MaterialKind::polished) return 1;
  return 1 - fresnel_dielectric(glm::dot(lit.at.normal, lit.at.to_viewer), lit.material.index);
}

}  // namespace rayfarm
