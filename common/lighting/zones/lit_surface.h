#pragma once
// Points of zones that light comes to and leaves from, with what is there of a material.
#include "common/lighting/zones/zone_map.h"
#include "common/materials/scattering.h"
#include "common/sampling/sampler.h"

namespace rayfarm {

/// What the random numbers are for that place a point on a zone.
inline constexpr uint32_t kOnZone = dimension::kLens;

/// Anywhere on a cell's side, by the random numbers of `id`. `seed`: the sampler's.
ZonePoint sample_zone(const ZoneMap& map, const Sampler& sampler, uint64_t seed, const ZoneGrid& grid,
                      uint32_t cell, uint32_t side, const SampleId& id);

/// A surface as it is seen from one direction, or as light from there finds it.
struct LitSurface {
  Surface surface;
  Material material;
  Interaction at;
  Lobes lobes;
};
/// `scene`: in a pass's colours. `choice`: of a mix. `index_ratio` of dielectrics is that against air.
LitSurface look_at(const Scene& scene, const ZoneMap& map, const Surface& surface, const Hit& hit,
                   const Vec3& to_viewer, double choice);

/// True if a polish may cover the material's substrate.
inline bool may_be_polished(const Material& material) {
  return material.kind == MaterialKind::polished || material.kind == MaterialKind::mix;
}
/// What a substrate sends through its polish to the viewer; 1 of other materials.
double passed_by_polish(const LitSurface& lit);

}  // namespace rayfarm
