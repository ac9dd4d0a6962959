#include "common/hierarchy/traverser.h"

#include "common/hierarchy/ray_log.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/hierarchy/traverser.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "common/hierarchy/items-inl.h"
#include "common/hierarchy/remembered-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayfarm {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

Hit find_closest(const Scene& scene, const Pose& pose, const Ray& ray) {
  Hit hit;
  hit.t = ray.t_max;
  ClosestHit search(scene, hit);
  search_scene(scene, pose, PreparedRay(ray), search);
  search.finish();
  return hit;
}

bool find_any(const Scene& scene, const Pose& pose, const Ray& ray) {
  AnyHit search(scene, ray.t_max);
  search_scene(scene, pose, PreparedRay(ray), search);
  return search.is_over();
}

void find_closest_of_packet(const Scene& scene, const Pose& pose, const RayPacket& rays, Hit* hits) {
  std::array<ClosestHit, kPacketRays> searches;
  for (size_t i = 0; i < rays.size; ++i) {
    hits[i] = {};
    hits[i].t = rays.t_max[i];
    searches[i] = ClosestHit(scene, hits[i]);
  }
  search_scene(scene, pose, rays, rays.all(), searches.data());
  for (size_t i = 0; i < rays.size; ++i) searches[i].finish();
}

uint32_t find_any_of_packet(const Scene& scene, const Pose& pose, const RayPacket& rays, uint32_t among) {
  std::array<AnyHit, kPacketRays> searches;
  for (size_t i = 0; i < kPacketRays; ++i)
    searches[i] = AnyHit(scene, among >> i & 1 ? rays.t_max[i] : 0);  // others may hold anything
  search_scene(scene, pose, rays, among, searches.data());
  uint32_t hits = 0;
  for (size_t i = 0; i < kPacketRays; ++i) hits |= static_cast<uint32_t>(searches[i].is_over()) << i;
  return hits;
}

Hit find_closest_among(const Scene& scene, const Pose& pose, std::span<const Item> items, const Ray& ray) {
  Hit hit;
  hit.t = ray.t_max;
  ClosestHit search(scene, hit);
  const PreparedRay world(ray);
  for (const Item& item : items) search_item(scene, pose, item, world, search);
  search.finish();
  return hit;
}

bool find_any_in_item(const Scene& scene, const Pose& pose, const Item& item, const Ray& ray) {
  AnyHit search(scene, ray.t_max);
  return search_item(scene, pose, item, PreparedRay(ray), search);
}

void test_all(const Scene& scene, const Part& part, uint32_t instance, const PreparedRay& ray,
              ClosestHit& search) {
  search.test_leaf(make_child(ChildKind::triangles, part.first_triangle_block, part.triangle_block_count),
                   ray, instance);
  search.test_leaf(make_child(ChildKind::spheres, part.first_sphere_block, part.sphere_block_count), ray,
                   instance);
  for (uint32_t i = 0; i < part.leaf_primitive_count; ++i) {
    const uint32_t place = part.first_leaf_primitive + i;  // what is in collections stands among these, too
    if (scene.leaf_primitives[place].kind() != PrimitiveKind::collection)
      search.test_leaf(make_child(ChildKind::mixed, place), ray, instance);
  }
}

Hit find_closest_brute_force(const Scene& scene, const Pose& pose, const Ray& ray) {
  Hit hit;
  hit.t = ray.t_max;
  ClosestHit search(scene, hit);
  const PreparedRay world(ray);
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const InstancePose& place = pose[i];
    if (place.is_hidden) continue;
    const PreparedRay local = place.is_identity ? world : PreparedRay(world, place.object_from_world);
    const Scene& shapes = pose.shape_of(i, scene);
    search.look_in(shapes);
    test_all(shapes, shapes.parts[scene.instances[i].part], i, local, search);
  }
  search.finish();
  return hit;
}

}  // namespace HWY_NAMESPACE
}  // namespace rayfarm
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayfarm {

HWY_EXPORT(find_closest);
HWY_EXPORT(find_any);
HWY_EXPORT(find_closest_of_packet);
HWY_EXPORT(find_any_of_packet);
HWY_EXPORT(find_closest_among);
HWY_EXPORT(find_any_in_item);
HWY_EXPORT(find_closest_brute_force);

namespace {

/// Those `among` the packet's rays.
void add_packet(std::vector<Ray>& log, const RayPacket& rays, uint32_t among) {
  for_each_lane(among, [&](size_t i) { log.push_back({rays.origin(i), rays.direction(i), rays.t_max[i]}); });
}

}  // namespace

Hit closest_hit(const Scene& scene, const Pose& pose, const Ray& ray) {
  if (scene.ray_log) scene.ray_log->closest.push_back(ray);
  return HWY_DYNAMIC_DISPATCH(find_closest)(scene, pose, ray);
}

bool any_hit(const Scene& scene, const Pose& pose, const Ray& ray) {
  if (scene.ray_log) scene.ray_log->any.push_back(ray);
  return HWY_DYNAMIC_DISPATCH(find_any)(scene, pose, ray);
}

void closest_hits(const Scene& scene, const Pose& pose, const RayPacket& rays, Hit* hits) {
  if (scene.ray_log) add_packet(scene.ray_log->closest, rays, rays.all());
  HWY_DYNAMIC_DISPATCH(find_closest_of_packet)(scene, pose, rays, hits);
}

uint32_t any_hits(const Scene& scene, const Pose& pose, const RayPacket& rays, uint32_t among) {
  if (scene.ray_log) add_packet(scene.ray_log->any, rays, among);
  return HWY_DYNAMIC_DISPATCH(find_any_of_packet)(scene, pose, rays, among);
}

// Here and not in a file of their own: they need all that rays do in hierarchies, compiled for every target.
Hit closest_hit_among(const Scene& scene, const Pose& pose, std::span<const Item> items, const Ray& ray) {
  return HWY_DYNAMIC_DISPATCH(find_closest_among)(scene, pose, items, ray);
}

bool hits_item(const Scene& scene, const Pose& pose, const Item& item, const Ray& ray) {
  return HWY_DYNAMIC_DISPATCH(find_any_in_item)(scene, pose, item, ray);
}

Hit closest_hit_brute_force(const Scene& scene, const Pose& pose, const Ray& ray) {
  return HWY_DYNAMIC_DISPATCH(find_closest_brute_force)(scene, pose, ray);
}

std::vector<std::string> simd_targets() {
  std::vector<std::string> names;
  for (const auto target : hwy::SupportedAndGeneratedTargets()) names.emplace_back(hwy::TargetName(target));
  return names;
}

void force_simd_target(const std::string& name) {
  hwy::SetSupportedTargetsForTest(0);
  if (!name.empty())
    for (const auto target : hwy::SupportedAndGeneratedTargets())
      if (name == hwy::TargetName(target)) {
        hwy::SetSupportedTargetsForTest(target);
        break;
      }
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace rayfarm
#endif
