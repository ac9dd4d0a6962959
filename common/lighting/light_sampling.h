#pragma once
// What sources send to a point: one sample of one source, or of one chosen at random.
#include "common/lighting/surface.h"
#include "common/sampling/sampler.h"

namespace rayfarm {

/// Light that arrives if nothing is in its way.
struct LightSample {
  Vec3 to_light{0};   ///< unit
  Vec3 target{0};     ///< where a shadow ray ends; for a distant light the vector to there is long enough
  Color incident{0};  ///< radiance / density: times BSDF × cosine it is the light scattered; 0: no light
  double pdf = 0;     ///< in solid angle; 0: the source has no extent
};

LightSample sample_light(const Scene& scene, const Pose& pose, const Light& light, const Vec3& p,
                         const Vec2& u);

/// Radiance that a material of `instance` emits to the viewer.
Color emission_at(const Scene& scene, const Pose& pose, uint32_t instance, const Material& material,
                  const Interaction& at);

/// Density in solid angle, about `origin`, with which sample_light chooses the point `surface` on a
/// luminaire.
double light_pdf(const Scene& scene, const Pose& pose, const Light& light, const Vec3& origin,
                 const Surface& surface);

/// In the world, at the first frame's poses.
double luminaire_area(const Scene& scene, const Light& light);

/// The source that a primitive is, or kNone.
uint32_t find_luminaire(const Scene& scene, uint32_t instance, PrimitiveId primitive);

/// True if light from the source can come from several directions.
inline bool has_extent(const Light& light) {
  return light.kind == LightKind::luminaire || light.kind == LightKind::environment;
}

}  // namespace rayfarm
