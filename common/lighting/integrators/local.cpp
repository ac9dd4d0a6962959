// The models of Phong (Equation 2.4) and of Torrance and Sparrow (thesis 2.2.3): light that comes from the
// sources straight away, and no other.
#include "common/lighting/environment.h"
#include "common/lighting/holes.h"
#include "common/lighting/integrators/classical_surfaces.h"
#include "common/lighting/integrators/integrator.h"
#include "common/lighting/item_buffers.h"
#include "common/lighting/participating_media.h"
#include "common/lighting/self_hits.h"

namespace rayfarm {
namespace {

class LocalIntegrator : public Integrator {
 public:
  explicit LocalIntegrator(Highlights::Shape shape) : highlights_{shape} {}

 private:
  size_t follow(const FrameContext& context, const RayPacket& rays, std::span<const SampleId> ids,
                RayCounts& counts, Color* colors) override {
    counts[RayTally::tree_depth] += rays.size;
    const Media in = context.eye_media ? *context.eye_media : Media();
    OfPacket<Hit> hits;
    find_eye_hits(context, rays, hits.data());
    if (is_by_medium(context)) [[unlikely]] {
      MediaOfRays media;
      media.fill(&in);
      keep_real_hits(context, rays, media, hits.data());
    }
    if (has_holes(context)) [[unlikely]]
      for (size_t i = 0; i < rays.size; ++i)
        hits[i] = next_solid_hit(
            context, rays[i], {ids[i], 0, 0, context.spread, is_by_medium(context) ? &in : nullptr}, hits[i]);
    ClassicalSurfaces surfaces(context, rays, hits.data());
    for (size_t i = 0; i < rays.size; ++i) {
      if (!hits[i].is_hit()) {
        colors[i] = eval_background(context.scene, rays.direction(i));
        continue;
      }
      surfaces.begin(context, i, context.width + hits[i].t * context.spread, ids[i], 0, context.eye_media);
      surfaces.add_ambient_and_emission(context, i);
    }
    add_direct_light(context, highlights_, surfaces, counts);
    for_each_lane(surfaces.met, [&](size_t i) { colors[i] = surfaces.light(i); });
    if (!context.scene.media.empty())
      for (size_t i = 0; i < rays.size; ++i)
        colors[i] *= transmittance(context.scene, {rays.origin(i), rays.direction(i), hits[i].t});
    return static_cast<size_t>(std::popcount(surfaces.met));
  }

  Highlights highlights_;
};

}  // namespace

std::unique_ptr<Integrator> make_phong() {
  return std::make_unique<LocalIntegrator>(Highlights::Shape::phong);
}

std::unique_ptr<Integrator> make_torrance_sparrow() {
  return std::make_unique<LocalIntegrator>(Highlights::Shape::torrance_sparrow);
}

}  // namespace rayfarm
