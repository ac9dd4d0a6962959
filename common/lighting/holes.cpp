#include "common/lighting/holes.h"

#include "common/hierarchy/primitive_bounds.h"
#include "common/lighting/principled_surface.h"
#include "common/lighting/self_hits.h"

namespace rayfarm {
namespace {

/// Holes that one ray passes: more are taken for damage.
constexpr int kMostHoles = 1000;

/// Calls enter(share that is open, number) at each surface that may be a hole, until it says no; returns the
/// hit there, or the first that is none.
template <typename Enter>
Hit walk(const FrameContext& context, const Ray& ray, Hit hit, const Media* media, double width,
         double spread, Enter enter) {
  const Scene& scene = context.scene;
  Ray rest = ray;     // from behind the last hole
  double passed = 0;  // of the ray, in front of `rest`
  for (int holes = 0; hit.is_hit() && holes < kMostHoles; ++holes) {
    if (!scene.materials[material_of(scene, hit.primitive)].is_pierced) break;
    const Surface surface = eval_surface(scene, context.pose, rest, hit);
    if (!enter(open_share(context, rest, hit, surface, width + (passed + hit.t) * spread), holes)) break;
    // Past the plane of the surface by its rounding, but never far where the ray grazes it.
    const double steepness = std::max(1e-3 * glm::length(ray.direction),
                                      std::abs(glm::dot(surface.geometric_normal, ray.direction)));
    passed += hit.t + surface.offset / steepness;
    if (!(passed < ray.t_max)) return {};
    rest.origin = ray.origin + passed * ray.direction;
    rest.t_max = ray.t_max - passed;
    hit = closest_hit(scene, context.pose, rest);
    if (media) hit = next_real_hit(context, rest, *media, hit);
  }
  if (hit.is_hit()) hit.t += passed;
  return hit;
}

}  // namespace

double open_share(const FrameContext& context, const Ray& ray, const Hit& hit, const Surface& surface,
                  double width) {
  const Scene& scene = context.scene;
  const PrincipledMaterial& m = scene.principled[scene.materials[surface.material].principled];
  if (m.is_one_sided && !surface.is_front) return 1;
  const PrincipledSource& source = m[PrincipledInput::opacity];
  const bool is_plain = source.texture == kNone && !scene.materials[surface.material].is_colored;
  const SurfacePatch patch =
      is_plain ? SurfacePatch() : patch_at(scene, context.pose, ray, hit, width, surface);
  const double opacity = std::clamp(eval_source(scene, source, patch).x * patch.color.w, 0.0, 1.0);
  if (m.cutoff > 0) return opacity < m.cutoff ? 1 : 0;
  return 1 - opacity;
}

Hit next_solid_hit(const FrameContext& context, const Ray& ray, const RayThroughHoles& through,
                   const Hit& first) {
  return walk(context, ray, first, through.media, through.width, through.spread, [&](double open, int hole) {
    if (!(open > 0) || open >= 1) return open >= 1;
    const auto stream = static_cast<uint32_t>(
        mix_bits(uint64_t{through.stream} << 32 | (1u << 16) | static_cast<uint32_t>(hole)));
    return context.tables.sampler.point(through.id, dimension::of_mix(stream)).x < open;
  });
}

double light_through_holes(const FrameContext& context, const Ray& ray, const Media* media) {
  Hit first = closest_hit(context.scene, context.pose, ray);
  if (media) first = next_real_hit(context, ray, *media, first);
  double left = 1;
  const Hit hit =
      walk(context, ray, first, media, 0, 0, [&](double open, int) { return (left *= open) > 0; });
  return hit.is_hit() && hit.t < ray.t_max ? 0 : left;
}

}  // namespace rayfarm
