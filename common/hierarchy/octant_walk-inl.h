// Rays through trees of octants (thesis 4.2.2, Figure 4.4's Volume_Traverse). Compiled once for each SIMD
// target.
#if defined(RAYFARM_COMMON_HIERARCHY_OCTANT_WALK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYFARM_COMMON_HIERARCHY_OCTANT_WALK_INL_H_
#undef RAYFARM_COMMON_HIERARCHY_OCTANT_WALK_INL_H_
#else
#define RAYFARM_COMMON_HIERARCHY_OCTANT_WALK_INL_H_
#endif

#include <hwy/highway.h>

#include <bit>

#include "common/hierarchy/bounding_volumes.h"
#include "common/hierarchy/cells-inl.h"
#include "common/hierarchy/octant_tree.h"

HWY_BEFORE_NAMESPACE();
namespace rayfarm {
namespace HWY_NAMESPACE {

template <typename Search>
class OctantWalk {
 public:
  OctantWalk(const Scene& scene, const Collection& collection, const OctantTree& tree,
             const PrimitiveRay& ray, uint32_t instance, Search& search)
      : pointers_(scene.primitive_pointers),
        volumes_(scene.octant_volumes.subspan(tree.first_volume, tree.volume_count)),
        origin_(ray.origin_vector()),
        direction_(ray.direction_vector()),
        search_(search),
        tests_(collection, ray, instance, search) {}

  /// True: the search is over.
  bool visit(uint32_t index) {
    const OctantVolume& volume = volumes_[index];
    const std::optional<double> entry = entry_into(Ball{volume.center, volume.radius}, origin_, direction_);
    const bool is_missed = !entry || *entry > search_.t_far();
    if constexpr (Search::kCounts) search_.count(volume, is_missed);
    if (is_missed) return false;
    if (volume.is_leaf()) return tests_.test(pointers_.subspan(volume.first, volume.pointer_count));
    const OctantOrder order(volume.center, origin_, direction_);
    for (size_t i = 0; i < order.count; ++i) {
      // "No primitive has been found": a list's primitive may be hit beyond its octant, so the hit must be
      // nearer than the next octant is.
      if (order.entries[i] > search_.t_far()) return false;
      const uint32_t bit = 1u << order.octants[i];
      if (!(volume.octants & bit)) continue;
      const auto before = static_cast<uint32_t>(std::popcount(volume.octants & (bit - 1)));
      if (visit(volume.first + before)) return true;
    }
    return false;
  }

 private:
  std::span<const PrimitivePointer> pointers_;
  std::span<const OctantVolume> volumes_;
  Vec3 origin_, direction_;
  Search& search_;
  CellTests<Search> tests_;
};

/// True: the search is over.
template <typename Search>
HWY_NOINLINE bool search_octants(const Scene& scene, const Collection& collection, const PrimitiveRay& ray,
                                 uint32_t instance, Search& search) {
  const OctantTree& tree = scene.octant_trees[collection.octants];
  if (is_too_far(tree.magnitude, ray.origin_vector())) return search_list(collection, ray, instance, search);
  return OctantWalk(scene, collection, tree, ray, instance, search).visit(0);
}

}  // namespace HWY_NAMESPACE
}  // namespace rayfarm
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
