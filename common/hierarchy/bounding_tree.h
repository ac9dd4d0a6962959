#pragma once
// Hierarchies of objects (thesis 2.6.1; Weghorst, Hooper and Greenberg 1984, section 3): their bounding
// volumes and those of groups.
#include "common/hierarchy/bounding_volumes.h"
#include "common/scene/scene.h"

namespace rayfarm {

/// What a tree is built of: a group, or an object with its primitives.
struct ObjectElement {
  std::vector<ObjectElement> children{};  ///< of a group
  std::array<ChildRef, 3> leaves{};       ///< of an object: triangles, spheres, others
  uint32_t instance = kNone;              ///< whose primitives they are; without leaves: all of it
  std::vector<BoundChoice> bound{};       ///< its volumes; empty: as the options say
  bool is_empty() const {
    return children.empty() && instance == kNone &&
           leaves[0].count() + leaves[1].count() + leaves[2].count() == 0;
  }
};

/// Groups of one element are that element, those of none are not there. Volumes that were given to it move
/// along.
ObjectElement without_idle_groups(ObjectElement element);

/// Appends the volumes and nodes of a tree to `arrays`; returns its index. Where elements have instances,
/// their poses are there. `eye` is used if the options ask for it.
uint32_t build_bounding_tree(ObjectElement root, const ObjectOptions& options, const std::optional<Vec3>& eye,
                             SceneArrays<GrowingArray>& arrays);

/// What the thesis's Table 4.5 counts.
struct ObjectSizes {
  uint64_t nodes = 0;     ///< objects and groups
  uint64_t pointers = 0;  ///< from groups to what is in them
  /// An object node has 88 bytes, a pointer 4 (thesis 4.3.2).
  uint64_t bytes() const { return 88 * nodes + 4 * pointers; }
};
/// Of the tree, with the trees of the instances in it.
ObjectSizes sizes_of(const Scene& scene, const BoundingTree& tree);

}  // namespace rayfarm
