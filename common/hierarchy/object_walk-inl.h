// Rays through hierarchies of objects (thesis Figures 2.15 and 4.4; Weghorst, Hooper and Greenberg 1984,
// Figure 4). Compiled once for each SIMD target.
#if defined(RAYFARM_COMMON_HIERARCHY_OBJECT_WALK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYFARM_COMMON_HIERARCHY_OBJECT_WALK_INL_H_
#undef RAYFARM_COMMON_HIERARCHY_OBJECT_WALK_INL_H_
#else
#define RAYFARM_COMMON_HIERARCHY_OBJECT_WALK_INL_H_
#endif

#include <hwy/highway.h>

#include "common/hierarchy/bounding_tree.h"
#include "common/hierarchy/cells.h"
#include "common/hierarchy/object_list.h"
#include "common/hierarchy/walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayfarm {
namespace HWY_NAMESPACE {

/// One ray's way through a tree of bounding volumes: groups and objects whose volumes it meets are listed;
/// the nearest is taken, until a hit is nearer than all that are left.
template <typename Search>
class ObjectWalk {
 public:
  /// `pose`: of the scene's tree, whose objects have instances; nullptr: all objects are `instance`'s.
  ObjectWalk(const Scene& scene, const BoundingTree& tree, const Pose* pose, const PrimitiveRay& ray,
             uint32_t instance, Search& search)
      : scene_(scene),
        tree_(tree),
        pose_(pose),
        ray_(ray),
        instance_(instance),
        search_(search),
        is_far_(is_too_far(tree.magnitude, ray.origin_vector())),
        is_sorted_(tree.order == ObjectOrder::sorted) {}

  /// True: the search is over. `is_inside`: the root's volumes are known to be met.
  bool run(bool is_inside) {
    if (is_inside)
      list({0, tree_.root});
    else if (test(tree_.root))
      return true;
    while (!list_.is_empty()) {
      const ListedObject next = is_sorted_ ? list_.take_nearest() : list_.take_last();
      if (is_sorted_ && next.entry > search_.t_far()) break;
      if (visit(scene_.bounding_nodes[next.node])) return true;
    }
    return false;
  }

 private:
  void list(const ListedObject& object) {
    if (is_sorted_)
      list_.add(object);
    else
      list_.push(object);
  }

  /// Lists what the ray may meet; an object that has no volume is looked into at once.
  bool test(uint32_t index) {
    const BoundingNode& node = scene_.bounding_nodes[index];
    if constexpr (Search::kCounts) search_.count_element();
    if (node.volume_count == 0 && !node.is_group()) return visit(node);
    double entry = 0;
    if (!is_far_)
      for (const BoundingVolume& volume :
           scene_.bounding_volumes.subspan(node.first_volume, node.volume_count)) {
        if constexpr (Search::kCounts) search_.count(volume);
        const std::optional<double> t = entry_into(volume, ray_.origin_vector(), ray_.direction_vector());
        if (!t) return false;
        entry = std::max(entry, *t);
      }
    list({entry, index});
    return false;
  }

  bool visit(const BoundingNode& node) {
    if constexpr (Search::kCounts) search_.count(node);
    if (node.is_group()) {
      for (uint32_t i = 0; i < node.child_count; ++i)
        if (test(node.first_child + i)) return true;
      return false;
    }
    if (node.instance == kNone) return visit_object(node, ray_, instance_);
    const InstancePose& place = (*pose_)[node.instance];
    if (place.is_identity) return visit_object(node, ray_, node.instance);
    return visit_object(node, PreparedRay(ray_, place.object_from_world), node.instance);
  }

  bool visit_object(const BoundingNode& node, const PrimitiveRay& ray, uint32_t instance) {
    for (const ChildRef& leaf : node.leaves)
      if (leaf.count() > 0 && search_.test_leaf(leaf, ray, instance)) return true;
    if (node.has_leaves()) return false;
    const Collection& collection = scene_.parts[scene_.instances[instance].part].collection;
    if (collection.structure != Structure::object)
      return search_collection(scene_, collection, ray, instance, search_);
    return ObjectWalk(scene_, scene_.bounding_trees[collection.tree], nullptr, ray, instance, search_)
        .run(true);
  }

  const Scene& scene_;
  const BoundingTree& tree_;
  const Pose* pose_;
  const PrimitiveRay& ray_;
  uint32_t instance_;
  Search& search_;
  bool is_far_, is_sorted_;
  ObjectList list_;
};

/// True: the search is over.
template <typename Search>
HWY_NOINLINE bool search_objects(const Scene& scene, const Collection& collection, const PrimitiveRay& ray,
                                 uint32_t instance, Search& search) {
  return ObjectWalk(scene, scene.bounding_trees[collection.tree], nullptr, ray, instance, search).run(false);
}

/// The scene's objects that never move. True: the search is over.
template <typename Search>
HWY_NOINLINE bool search_scene_objects(const Scene& scene, const Pose& pose, const PrimitiveRay& ray,
                                       Search& search) {
  return ObjectWalk(scene, scene.bounding_trees[scene.head().object_tree], &pose, ray, kNone, search)
      .run(false);
}

}  // namespace HWY_NAMESPACE
}  // namespace rayfarm
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
