#include "common/hierarchy/items.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/hierarchy/items.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "common/hierarchy/items-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayfarm {
namespace HWY_NAMESPACE {

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

}  // namespace HWY_NAMESPACE
}  // namespace rayfarm
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayfarm {

HWY_EXPORT(find_closest_among);
HWY_EXPORT(find_any_in_item);

Hit closest_hit_among(const Scene& scene, const Pose& pose, std::span<const Item> items, const Ray& ray) {
  return HWY_DYNAMIC_DISPATCH(find_closest_among)(scene, pose, items, ray);
}

bool hits_item(const Scene& scene, const Pose& pose, const Item& item, const Ray& ray) {
  return HWY_DYNAMIC_DISPATCH(find_any_in_item)(scene, pose, item, ray);
}

}  // namespace rayfarm
#endif
