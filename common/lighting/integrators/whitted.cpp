// Whitted's model (Equation 2.12): Phong's terms, and light along the mirrored and the refracted ray.
#include "common/lighting/environment.h"
#include "common/lighting/integrators/integrator.h"
#include "common/lighting/integrators/lighting_tree.h"

namespace rayfarm {
namespace {

class WhittedIntegrator : public Integrator {
 private:
  size_t follow(const FrameContext& context, const RayPacket& rays, std::span<const SampleId> ids,
                RayCounts& counts, Color* colors) override {
    tree_.plant(rays, ids, context.spread, colors);
    const size_t eye_hits = trace(context, *tree_.next_batch(), counts);
    while (Batch* const batch = tree_.next_batch()) trace(context, *batch, counts);
    return eye_hits;
  }

  /// Returns how many rays met an object.
  size_t trace(const FrameContext& context, Batch& batch, RayCounts& counts) {
    OfPacket<Hit> hits;
    hits.resize_for_overwrite(batch.rays.size);
    closest_hits(context.scene, context.pose, batch.rays, hits.data());
    OfPacket<ClassicalSurface> surfaces;
    OfPacket<size_t> ray_of_surface;
    for (size_t i = 0; i < batch.rays.size; ++i) {
      if (!hits[i].is_hit()) {
        tree_.deliver(batch.branches[i].receiver, eval_background(context.scene, batch.rays.direction(i)));
        continue;
      }
      Branch& branch = batch.branches[i];
      branch.arrive(context.scene, hits[i].t);
      ClassicalSurface& surface =
          surfaces.emplace_back(context, batch.rays[i], hits[i], branch.width, branch.id, branch.stream);
      surface.media = &branch.media;
      surface.add_ambient_and_emission(context);
      ray_of_surface.push_back(i);
    }
    if (!surfaces.empty()) {
      add_direct_light(context, {.has_reflected_rays = true}, surfaces.span(), counts);
      follow_secondary(context, batch, surfaces.span(), ray_of_surface.span(), counts);
    }
    LightingTree::end(batch);
    return surfaces.size();
  }

  /// `ray_of`: the ray of the batch that met each surface.
  void follow_secondary(const FrameContext& context, const Batch& batch,
                        std::span<const ClassicalSurface> surfaces, std::span<const size_t> ray_of,
                        RayCounts& counts) {
    const RenderSettings& settings = context.tables.settings;
    Batch *reflected = &tree_.begin_batch(batch.depth + 1),
          *transmitted = &tree_.begin_batch(batch.depth + 1);
    for (size_t k = 0; k < surfaces.size(); ++k) {
      const Branch& branch = batch.branches[ray_of[k]];
      SecondaryRays secondary;
      if (batch.depth < settings.max_depth && surfaces[k].has_secondary_rays())
        secondary = secondary_rays(surfaces[k], branch, settings);
      if (secondary.transmitted_rays + secondary.reflected_rays == 0) {
        tree_.deliver(branch.receiver, surfaces[k].light());
        continue;
      }
      const uint32_t fork = tree_.add_fork(branch.receiver, surfaces[k].light());
      tree_.grow_secondary(context, fork, branch, surfaces[k], secondary, transmitted, reflected);
      counts[RayKind::transmitted] += secondary.transmitted_rays;
      counts[RayKind::reflected] += secondary.reflected_rays;
    }
  }

  LightingTree tree_;
};

}  // namespace

std::unique_ptr<Integrator> make_whitted() {
  return std::make_unique<WhittedIntegrator>();
}

}  // namespace rayfarm
