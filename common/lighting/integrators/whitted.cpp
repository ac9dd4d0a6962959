// Whitted's model (Equation 2.12): Phong's terms, and light along the mirrored and the refracted ray.
#include "common/lighting/environment.h"
#include "common/lighting/integrators/integrator.h"
#include "common/lighting/integrators/lighting_tree.h"

namespace rayfarm {
namespace {

class WhittedIntegrator : public Integrator {
 private:
  size_t follow(const FrameContext& context, std::span<const Ray> rays, std::span<const SampleId> ids,
                RayCounts& counts, Color* colors) override {
    const size_t eye_hits = trace(context, tree_.plant(rays, ids, context.spread, colors), counts);
    while (tree_.has_batch()) trace(context, tree_.pop(), counts);
    return eye_hits;
  }

  /// Returns how many rays met an object.
  size_t trace(const FrameContext& context, Batch batch, RayCounts& counts) {
    std::array<Hit, kMostPacketRays> hits;
    closest_hits(context.scene, context.pose, batch.rays.span(), hits.data());
    OfPacket<ClassicalSurface> surfaces;
    OfPacket<size_t> ray_of_surface;
    for (size_t i = 0; i < batch.rays.size(); ++i) {
      if (!hits[i].is_hit()) {
        tree_.deliver(batch.branches[i].receiver, eval_background(context.scene, batch.rays[i].direction));
        continue;
      }
      Branch& branch = batch.branches[i];
      branch.width += hits[i].t * branch.spread;
      surfaces.emplace_back(context, batch.rays[i], hits[i], branch.width, branch.id, branch.stream)
          .add_ambient_and_emission(context.scene);
      ray_of_surface.push_back(i);
    }
    if (surfaces.empty()) return 0;
    add_direct_light(context, {.has_reflected_rays = true}, surfaces.span(), counts);

    const RenderSettings& settings = context.tables.settings;
    Batch transmitted(batch.depth + 1), reflected(batch.depth + 1);
    for (size_t k = 0; k < surfaces.size(); ++k) {
      const Branch& branch = batch.branches[ray_of_surface[k]];
      SecondaryRays secondary;
      if (batch.depth < settings.max_depth && surfaces[k].has_secondary_rays())
        secondary = secondary_rays(surfaces[k], branch.weight, settings.min_weight);
      if (!secondary.is_transmitted && !secondary.is_reflected) {
        tree_.deliver(branch.receiver, surfaces[k].light());
        continue;
      }
      const uint32_t fork = tree_.add_fork(branch.receiver, surfaces[k].light());
      tree_.grow_secondary(fork, branch, surfaces[k].surface, secondary, transmitted, reflected);
    }
    counts[RayKind::transmitted] += transmitted.rays.size();
    counts[RayKind::reflected] += reflected.rays.size();
    tree_.push(reflected);
    tree_.push(transmitted);
    return surfaces.size();
  }

  LightingTree tree_;
};

}  // namespace

std::unique_ptr<Integrator> make_whitted() {
  return std::make_unique<WhittedIntegrator>();
}

}  // namespace rayfarm
