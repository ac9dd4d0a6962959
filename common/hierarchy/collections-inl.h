// Collections of primitives by what finds those that a ray meets. Compiled once for each SIMD target.
#if defined(RAYFARM_COMMON_HIERARCHY_COLLECTIONS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYFARM_COMMON_HIERARCHY_COLLECTIONS_INL_H_
#undef RAYFARM_COMMON_HIERARCHY_COLLECTIONS_INL_H_
#else
#define RAYFARM_COMMON_HIERARCHY_COLLECTIONS_INL_H_
#endif

#include <hwy/highway.h>

#include "common/hierarchy/grid-inl.h"
#include "common/hierarchy/object_walk-inl.h"
#include "common/hierarchy/octant_walk-inl.h"
#include "common/hierarchy/octree-inl.h"
#include "common/hierarchy/walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayfarm {
namespace HWY_NAMESPACE {

/// Searches a collection with one ray; true: the search is over. Collections in collections are found so,
/// too.
template <typename Search>
HWY_NOINLINE bool search_collection(const Scene& scene, const Collection& collection, const PrimitiveRay& ray,
                                    uint32_t instance, Search& search) {
  switch (collection.structure) {
    case Structure::volumes: {
      const PreparedRay prepared(ray);
      SingleWalker walker(prepared, search);
      return walk_volumes(scene, collection, instance, walker);
    }
    case Structure::list:
      return search_list(collection, ray, instance, search);
    case Structure::regular:
      return search_grid(scene, collection, ray, instance, search);
    case Structure::object:
      return search_objects(scene, collection, ray, instance, search);
    case Structure::adaptive:
      return search_octree(scene, collection, ray, instance, search);
    case Structure::octants:
      return search_octants(scene, collection, ray, instance, search);
  }
  return false;
}

/// The same of a collection that is a primitive of another one: what misses its box is not tested with a
/// list. Other structures look at their boxes themselves.
template <typename Search>
HWY_NOINLINE bool search_inner_collection(const Scene& scene, const Collection& collection,
                                          const PrimitiveRay& ray, uint32_t instance, Search& search) {
  if (collection.structure == Structure::list &&
      !is_too_far(collection.bounds.magnitude(), ray.origin_vector())) {
    const Passage passage = passage_through(with_margin(collection.bounds), ray);
    if (passage.is_empty() || passage.begin > search.t_far()) return false;
  }
  return search_collection(scene, collection, ray, instance, search);
}

}  // namespace HWY_NAMESPACE
}  // namespace rayfarm
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
