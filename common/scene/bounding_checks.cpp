#include "common/scene/bounding_checks.h"

#include <cmath>

#include "common/scene/check_tools.h"

namespace rayfarm {
namespace {

/// The primitives that the objects of a tree may name.
struct Owner {
  const Collection* collection = nullptr;  ///< nullptr: any of the instances that never move
};

class BoundingChecks {
 public:
  explicit BoundingChecks(const Scene& s)
      : s_(s), is_met_(s.bounding_nodes.size()), is_named_(s.leaf_primitives.size()) {}

  void check(uint32_t tree, const Owner& owner) {
    const BoundingTree& t = s_.bounding_trees[tree];
    require(t.order <= ObjectOrder::all && std::isfinite(t.magnitude), "a tree of bounding volumes");
    meet(t.root);
    std::vector<uint32_t> left{t.root};
    while (!left.empty()) {
      const uint32_t index = left.back();
      left.pop_back();
      const BoundingNode& node = s_.bounding_nodes[index];
      check_volumes(node);
      if (!node.is_group()) {
        check_object(node, owner);
        continue;
      }
      // Children stand after their parents, and have one each, so a walk ends.
      require(node.first_child > index && node.first_child < s_.bounding_nodes.size() &&
                  node.child_count <= s_.bounding_nodes.size() - node.first_child,
              "a group's elements");
      for (uint32_t i = 0; i < node.child_count; ++i) {
        meet(node.first_child + i);
        left.push_back(node.first_child + i);
      }
    }
  }

  void check_all_met() const {
    for (const bool is_met : is_met_) require(is_met, "an object of no tree");
  }

 private:
  void meet(uint32_t node) {
    require(node < is_met_.size() && !is_met_[node], "an object in a tree");
    is_met_[node] = true;
  }

  void check_volumes(const BoundingNode& node) const {
    require(node.first_volume <= s_.bounding_volumes.size() &&
                node.volume_count <= s_.bounding_volumes.size() - node.first_volume,
            "an object's bounding volumes");
    for (const BoundingVolume& v : s_.bounding_volumes.subspan(node.first_volume, node.volume_count)) {
      require(v.kind <= VolumeKind::slabs, "a bounding volume's kind");
      for (const double number : v.numbers) require(std::isfinite(number), "a bounding volume");
    }
  }

  void check_object(const BoundingNode& node, const Owner& owner) {
    require((node.instance == kNone) == (owner.collection != nullptr), "an object's instance");
    const Collection* collection = owner.collection;
    if (!collection) {
      require(node.instance < s_.instances.size() && s_.instances[node.instance].moving == kNone &&
                  s_.instances[node.instance].part < s_.parts.size(),
              "an object's instance");
      collection = &s_.parts[s_.instances[node.instance].part].collection;
    }
    constexpr std::array kinds{ChildKind::triangles, ChildKind::spheres, ChildKind::mixed};
    const std::array<std::array<uint32_t, 2>, 3> own{
        {{collection->first_triangle_block, collection->triangle_block_count},
         {collection->first_sphere_block, collection->sphere_block_count},
         {collection->first_leaf_primitive, collection->leaf_primitive_count}}};
    for (size_t i = 0; i < 3; ++i) {
      const ChildRef& leaf = node.leaves[i];
      if (leaf.count() == 0) {
        require(leaf.kind() == ChildKind::empty, "an object's primitives");
        continue;
      }
      require(leaf.kind() == kinds[i] && leaf.first >= own[i][0] &&
                  uint64_t{leaf.first} + leaf.count() <= uint64_t{own[i][0]} + own[i][1],
              "an object's primitives");
    }
    require(node.has_leaves() || !owner.collection, "an object without primitives");
    if (!owner.collection) return;
    // What a collection holds is in one of its objects, so that collections in it are searched once.
    const ChildRef& others = node.leaves[2];
    for (uint32_t i = 0; i < others.count(); ++i) {
      require(!is_named_[others.first + i], "a primitive of two objects");
      is_named_[others.first + i] = true;
    }
  }

  const Scene& s_;
  std::vector<bool> is_met_;
  std::vector<bool> is_named_;  ///< leaf_primitives, by objects of collections
};

}  // namespace

void check_bounding_trees(const Scene& s) {
  BoundingChecks checks(s);
  for (const Collection& c : s.collections)
    if (c.tree != kNone) checks.check(c.tree, {&c});
  for (const Part& part : s.parts)
    if (part.collection.tree != kNone) checks.check(part.collection.tree, {&part.collection});
  const uint32_t tree = s.head().object_tree;
  if (tree != kNone) {
    require(tree < s.bounding_trees.size(), "the scene's tree of objects");
    checks.check(tree, {});
  }
  checks.check_all_met();
}

}  // namespace rayfarm
