// Whitted's model (Equation 2.12): Phong's terms, and light along the mirrored and the refracted ray.
#include "common/lighting/environment.h"
#include "common/lighting/holes.h"
#include "common/lighting/integrators/integrator.h"
#include "common/lighting/integrators/lighting_tree.h"
#include "common/lighting/item_buffers.h"
#include "common/lighting/participating_media.h"

namespace rayfarm {
namespace {

class WhittedIntegrator : public Integrator {
 private:
  size_t follow(const FrameContext& context, const RayPacket& rays, std::span<const SampleId> ids,
                RayCounts& counts, Color* colors) override {
    const size_t eye_hits = trace(context, 1, rays, tree_.plant(context, ids, colors), counts);
    while (Batch* const batch = tree_.next_batch()) {
      trace(context, batch->depth, batch->rays, batch->branches, counts);
      LightingTree::end(*batch);
    }
    counts[RayTally::tree_depth] += tree_.depths();
    return eye_hits;
  }

  /// Returns how many rays met an object.
  size_t trace(const FrameContext& context, uint32_t depth, const RayPacket& rays, OfPacket<Branch>& branches,
               RayCounts& counts) {
    OfPacket<Hit> hits;
    if (depth == 1)
      find_eye_hits(context, rays, hits.data());
    else
      closest_hits(context.scene, context.pose, rays, hits.data());
    if (is_by_medium(context)) [[unlikely]]
      keep_real_hits(context, rays, media_of(branches), hits.data());
    if (has_holes(context)) [[unlikely]]
      pass_holes(context, rays, branches, hits.data());
    ClassicalSurfaces surfaces(context, rays, hits.data());
    for (size_t i = 0; i < rays.size; ++i) {
      Branch& branch = branches[i];
      if (!context.scene.media.empty())
        branch.weaken(transmittance(context.scene, {rays.origin(i), rays.direction(i), hits[i].t}));
      if (!hits[i].is_hit()) {
        tree_.deliver(branch.receiver, eval_background(context.scene, rays.direction(i)));
        continue;
      }
      branch.arrive(context.scene, hits[i].t);
      surfaces.begin(context, i, branch.width, branch.id, branch.stream, &branch.media);
      surfaces.add_ambient_and_emission(context, i);
    }
    if (surfaces.met) {
      add_direct_light(context, {.has_reflected_rays = true}, surfaces, counts);
      follow_secondary(context, depth, branches, surfaces, counts);
    }
    return static_cast<size_t>(std::popcount(surfaces.met));
  }

  void follow_secondary(const FrameContext& context, uint32_t depth, const OfPacket<Branch>& branches,
                        const ClassicalSurfaces& surfaces, RayCounts& counts) {
    const RenderSettings& settings = context.tables.settings;
    Batch *reflected = &tree_.begin_batch(depth + 1), *transmitted = &tree_.begin_batch(depth + 1);
    for_each_lane(surfaces.met, [&](size_t i) {
      const Branch& branch = branches[i];
      SecondaryRays secondary;
      if (depth < settings.max_depth && surfaces.has_secondary_rays(i)) {
        secondary = secondary_rays(surfaces, i, branch, settings);
        counts[RayTally::cut] += secondary.cut_rays;
      }
      if (secondary.transmitted_rays + secondary.reflected_rays == 0) {
        tree_.deliver(branch.receiver, surfaces.light(i));
        return;
      }
      const uint32_t fork = tree_.add_fork(branch.receiver, surfaces.light(i));
      tree_.grow_secondary(context, fork, branch, surfaces, i, secondary, transmitted, reflected);
      counts[RayKind::transmitted] += secondary.transmitted_rays;
      counts[RayKind::reflected] += secondary.reflected_rays;
    });
  }

  LightingTree tree_;
};

}  // namespace

std::unique_ptr<Integrator> make_whitted() {
  return std::make_unique<WhittedIntegrator>();
}

}  // namespace rayfarm
