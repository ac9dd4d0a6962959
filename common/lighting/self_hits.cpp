#include "common/lighting/self_hits.h"

#include <vector>

#include "common/hierarchy/traverser.h"

namespace rayfarm {
namespace {

/// Surfaces that one ray passes without meeting them, or the ray that finds what the eye is in: more are
/// taken for damage.
constexpr int kMostPassed = 1000;

/// Of the rounding bound: the first step past a hit that is none, about a unit in the last place.
constexpr double kLeastStep = 0x1p-8;

bool is_real(const Scene& scene, const Surface& surface, const Media& media) {
  return is_sheet(scene.materials[surface.material]) || surface.is_front == !media.contains(surface.material);
}

}  // namespace

bool is_sheet(const Material& material) {
  return material.kind == MaterialKind::translucent || material.kind == MaterialKind::mix ||
         material.is_pierced != 0;
}

Hit next_real_hit(const FrameContext& context, const Ray& ray, const Media& media, const Hit& first) {
  Hit hit = first;
  Ray rest = ray;     // from where the last hit was none
  double passed = 0;  // of the ray, in front of `rest`
  // The search goes on from the hit that was none by steps as small as rounding allows, so that what lies
  // just behind is not passed: it may be what the ray is to hit.
  double step = kLeastStep;
  for (int hits = 0; hit.is_hit() && hits < kMostPassed; ++hits, step = std::min(1.0, 2 * step)) {
    const Surface surface = eval_surface(context.scene, context.pose, rest, hit);
    if (is_real(context.scene, surface, media)) {
      hit.t += passed;
      return hit;
    }
    passed += std::max(hit.t, step * surface.offset / glm::length(ray.direction));
    if (!(passed < ray.t_max)) break;
    rest.origin = ray.origin + passed * ray.direction;
    rest.t_max = ray.t_max - passed;
    hit = closest_hit(context.scene, context.pose, rest);
  }
  return {};
}

void keep_real_hits(const FrameContext& context, const RayPacket& rays, const MediaOfRays& media, Hit* hits) {
  Surfaces surfaces;
  const uint32_t met = eval_surfaces(context.scene, context.pose, rays, hits, surfaces);
  for_each_lane(met, [&](size_t i) {
    if (!is_real(context.scene, surfaces[i], *media[i]))
      hits[i] = next_real_hit(context, rays[i], *media[i], hits[i]);
  });
}

uint32_t any_real_hits(const FrameContext& context, const RayPacket& rays, const MediaOfRays& media,
                       uint32_t among) {
  uint32_t blocked = 0;
  for_each_lane(any_hits(context.scene, context.pose, rays, among), [&](size_t i) {
    const Ray ray = rays[i];
    const Hit hit = next_real_hit(context, ray, *media[i], closest_hit(context.scene, context.pose, ray));
    if (hit.is_hit() && hit.t < ray.t_max) blocked |= 1u << i;
  });
  return blocked;
}

Surface laid_on_surface(const Scene& scene, Surface surface) {
  if (!is_sheet(scene.materials[surface.material])) surface.offset = 0;
  return surface;
}

void lay_on_surfaces(const Scene& scene, uint32_t met, Surfaces& surfaces) {
  for_each_lane(met, [&](size_t i) {
    if (!is_sheet(scene.materials[surfaces.material[i]])) surfaces.offset[i] = 0;
  });
}

void leave(const Scene& scene, Surface surface, const Vec3& direction, Media& media) {
  if (glm::dot(surface.geometric_normal, direction) >= 0) return;
  const bool is_body = surface.offset == 0;
  if (is_body || has_inside(scene.materials[surface.material]))
    media.cross(surface.material, surface.is_front);
}

Media find_eye_media(const Scene& scene, const Pose& pose, const Ray& middle) {
  Media entered;
  std::vector<uint32_t> around;  // from the innermost out
  Ray ray = middle;
  for (int passed = 0; passed < kMostPassed; ++passed) {
    const Hit hit = closest_hit(scene, pose, ray);
    if (!hit.is_hit()) break;
    const Surface surface = eval_surface(scene, pose, ray, hit);
    if (!is_sheet(scene.materials[surface.material])) {
      if (surface.is_front || entered.contains(surface.material))
        entered.cross(surface.material, surface.is_front);
      else
        around.push_back(surface.material);
    }
    ray.origin = surface.ray_origin(ray.direction);
  }
  Media media;
  for (size_t i = around.size(); i-- > 0;) media.cross(around[i], true);
  return media;
}

}  // namespace rayfarm
