#include "common/hierarchy/walk_counts.h"

// For one target: what is counted does not depend on it.
#include <hwy/highway.h>

#include <bit>

#include "common/hierarchy/items-inl.h"
#include "common/hierarchy/remembered-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayfarm {
namespace HWY_NAMESPACE {
namespace {

/// A search that counts what it tests.
template <typename Search>
class Counting : public Search {
 public:
  static constexpr bool kCounts = true;
  template <typename... Arguments>
  Counting(WalkCounts& counts, const Scene& scene, Arguments&&... arguments)
      : Search(scene, arguments...), counts_(&counts), scene_(&scene) {}

  void look_in(const Scene& scene) {
    Search::look_in(scene);
    scene_ = &scene;
  }

  void count(const VolumeNode& node) {
    ++counts_->nodes;
    for (const ChildRef& child : node.children) counts_->boxes += child.kind() != ChildKind::empty;
  }

  void count_cell(uint32_t listed) {
    ++counts_->cells;
    if (listed == 0) {
      ++counts_->empty_cells;
      return;
    }
    const auto fill = static_cast<size_t>(std::bit_width(listed) - 1);
    ++counts_->visits_by_fill[fill];
    counts_->tests_by_fill[fill] += listed;
  }
  void count_tree_node() { ++counts_->tree_nodes; }
  void count_chain_step() { ++counts_->chain_steps; }
  void count_last_hit_test() { ++counts_->last_hit_tests; }
  void count_last_hit() { ++counts_->last_hits; }
  void count_coherent_ray() { ++counts_->coherent_rays; }
  void count_list() { ++counts_->lists; }
  void count_candidate() { ++counts_->candidates; }
  void count_saved_test() { ++counts_->saved_tests; }
  void count_element() { ++counts_->elements; }
  void count(const OctantVolume& volume, bool is_missed) {
    ++(volume.is_leaf() ? counts_->leaf_volumes : counts_->interior_volumes);
    counts_->missed_volumes += is_missed;
  }
  void count(const BoundingVolume& volume) { ++counts_->bounds[static_cast<size_t>(volume.kind)]; }
  void count(const BoundingNode& node) {
    if (node.is_group()) ++counts_->groups;
    if (std::any_of(node.leaves.begin(), node.leaves.end(), [](const ChildRef& c) { return c.count() > 0; }))
      ++counts_->objects;
  }

  bool test_leaf(const ChildRef& leaf, const PrimitiveRay& ray, uint32_t instance) {
    ++counts_->leaves;
    counts_->curved_leaves += is_curved(leaf);
    if (leaf.kind() == ChildKind::triangles) count_triangles(leaf);
    if (leaf.kind() == ChildKind::spheres)
      for (const SphereBlock& block : scene_->sphere_blocks.subspan(leaf.first, leaf.count()))
        for (const uint32_t sphere : block.spheres) counts_->spheres += sphere != kNone;
    if (leaf.kind() == ChildKind::mixed) return test_mixed(leaf, ray, instance);
    return Search::test_leaf(leaf, ray, instance);
  }

  bool test(const PrimitivePointer& pointer, const PrimitiveRay& ray, uint32_t instance) {
    if (pointer.kind() == PointerKind::other)
      return test_mixed(make_child(ChildKind::mixed, pointer.place()), ray, instance);
    const bool is_sphere = pointer.kind() == PointerKind::sphere;
    const PrimitiveId id = is_sphere
                               ? PrimitiveId{}
                               : scene_->triangle_blocks[pointer.place() / 8].primitives[pointer.place() % 8];
    ++(is_sphere                              ? counts_->spheres
       : id.kind() == PrimitiveKind::triangle ? counts_->triangles
                                              : counts_->polygons);
    return Search::test(pointer, ray, instance);
  }

 private:
  bool is_curved(const ChildRef& leaf) const {
    if (leaf.kind() != ChildKind::mixed || leaf.count() == 0) return leaf.kind() == ChildKind::spheres;
    return scene_->leaf_primitives[leaf.first].kind() == PrimitiveKind::quadric;
  }

  /// A primitive that was cut into triangles is one, wherever in the leaf they stand; in a long list they
  /// stand one behind the other.
  void count_triangles(const ChildRef& leaf) {
    constexpr size_t kFarthest = 64;
    std::vector<PrimitiveId>& seen = seen_;
    seen.clear();
    for (const TriangleBlock& block : scene_->triangle_blocks.subspan(leaf.first, leaf.count()))
      for (const PrimitiveId id : block.primitives) {
        if (id == kNoPrimitive) continue;
        const auto begin = seen.end() - static_cast<ptrdiff_t>(std::min(seen.size(), kFarthest));
        if (std::find(begin, seen.end(), id) != seen.end()) continue;
        seen.push_back(id);
        ++(id.kind() == PrimitiveKind::triangle ? counts_->triangles : counts_->polygons);
      }
  }

  /// One by one: what is in a collection is counted, not the collection.
  bool test_mixed(const ChildRef& leaf, const PrimitiveRay& ray, uint32_t instance) {
    for (uint32_t i = leaf.first; i < leaf.first + leaf.count(); ++i) {
      const PrimitiveId id = scene_->leaf_primitives[i];
      if (id.kind() == PrimitiveKind::collection) {
        if (search_inner_collection(*scene_, scene_->collections[id.index()], ray, instance, *this))
          return true;
        continue;
      }
      ++(id.kind() == PrimitiveKind::polygon ? counts_->polygons : counts_->quadrics);
      if (Search::test_leaf(make_child(ChildKind::mixed, i), ray, instance)) return true;
    }
    return false;
  }

  WalkCounts* counts_;
  std::vector<PrimitiveId> seen_;
  const Scene* scene_;
};

}  // namespace
}  // namespace HWY_NAMESPACE

WalkCounts& WalkCounts::operator+=(const WalkCounts& other) {
  for (const auto count : {&WalkCounts::nodes,        &WalkCounts::boxes,
                           &WalkCounts::cells,        &WalkCounts::empty_cells,
                           &WalkCounts::tree_nodes,   &WalkCounts::chain_steps,
                           &WalkCounts::saved_tests,  &WalkCounts::last_hit_tests,
                           &WalkCounts::last_hits,    &WalkCounts::coherent_rays,
                           &WalkCounts::lists,        &WalkCounts::candidates,
                           &WalkCounts::leaves,       &WalkCounts::curved_leaves,
                           &WalkCounts::elements,     &WalkCounts::interior_volumes,
                           &WalkCounts::leaf_volumes, &WalkCounts::missed_volumes,
                           &WalkCounts::groups,       &WalkCounts::objects,
                           &WalkCounts::triangles,    &WalkCounts::spheres,
                           &WalkCounts::polygons,     &WalkCounts::quadrics})
    this->*count += other.*count;
  for (size_t i = 0; i < bounds.size(); ++i) bounds[i] += other.bounds[i];
  for (size_t i = 0; i < tests_by_fill.size(); ++i) {
    visits_by_fill[i] += other.visits_by_fill[i];
    tests_by_fill[i] += other.tests_by_fill[i];
  }
  return *this;
}

Hit closest_hit_counted(const Scene& scene, const Pose& pose, const Ray& ray, WalkCounts& counts) {
  using namespace HWY_NAMESPACE;
  Hit hit;
  hit.t = ray.t_max;
  Counting<ClosestHit> search(counts, scene, hit);
  search_scene(scene, pose, PreparedRay(ray), search);
  search.finish();
  return hit;
}

Hit closest_hit_among_counted(const Scene& scene, const Pose& pose, std::span<const Item> items,
                              const Ray& ray, WalkCounts& counts) {
  using namespace HWY_NAMESPACE;
  Hit hit;
  hit.t = ray.t_max;
  Counting<ClosestHit> search(counts, scene, hit);
  const PreparedRay world(ray);
  for (const Item& item : items) search_item(scene, pose, item, world, search);
  search.finish();
  return hit;
}

bool any_hit_counted(const Scene& scene, const Pose& pose, const Ray& ray, WalkCounts& counts) {
  using namespace HWY_NAMESPACE;
  Counting<AnyHit> search(counts, scene, ray.t_max);
  search_scene(scene, pose, PreparedRay(ray), search);
  return search.is_over();
}

}  // namespace rayfarm
HWY_AFTER_NAMESPACE();
