// Rays that are asked about one item. Compiled once for each SIMD target.
#if defined(RAYFARM_COMMON_HIERARCHY_ITEMS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYFARM_COMMON_HIERARCHY_ITEMS_INL_H_
#undef RAYFARM_COMMON_HIERARCHY_ITEMS_INL_H_
#else
#define RAYFARM_COMMON_HIERARCHY_ITEMS_INL_H_
#endif

#include <hwy/highway.h>

#include "common/hierarchy/collections-inl.h"
#include "common/hierarchy/items.h"
#include "common/hierarchy/scene_walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayfarm {
namespace HWY_NAMESPACE {

/// `ray`: in the space of the item's instance. True: the search is over.
template <typename Search>
bool search_item_in_object(const Scene& scene, const Item& item, const PrimitiveRay& ray, Search& search) {
  if (!item.is_object()) return search.test(item.primitive(), ray, item.instance);
  const BoundingNode& node = scene.bounding_nodes[item.node()];
  if constexpr (Search::kCounts) search.count(node);
  for (const ChildRef& leaf : node.leaves)
    if (leaf.count() > 0 && search.test_leaf(leaf, ray, item.instance)) return true;
  return false;
}

template <typename Search>
bool search_item(const Scene& scene, const Pose& pose, const Item& item, const PreparedRay& world,
                 Search& search) {
  const InstancePose& place = pose[item.instance];
  const auto search_in = [&](const Scene& shapes) HWY_ATTR {
    if (place.is_identity) return search_item_in_object(shapes, item, world, search);
    return search_item_in_object(shapes, item, PreparedRay(world, place.object_from_world), search);
  };
  if (HWY_LIKELY(!place.is_deformed)) return search_in(scene);
  return walk_shapes(scene, pose, item.instance, search, search_in);
}

}  // namespace HWY_NAMESPACE
}  // namespace rayfarm
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
