// Rays through octrees (Glassner 1984; thesis 4.2.2; Shirley, Sung and Brown 1991, 2.3). Compiled once for
// each SIMD target.
#if defined(RAYFARM_COMMON_HIERARCHY_OCTREE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYFARM_COMMON_HIERARCHY_OCTREE_INL_H_
#undef RAYFARM_COMMON_HIERARCHY_OCTREE_INL_H_
#else
#define RAYFARM_COMMON_HIERARCHY_OCTREE_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "common/hierarchy/cells-inl.h"
#include "common/hierarchy/growing_octree.h"
#include "common/hierarchy/octree.h"

HWY_BEFORE_NAMESPACE();
namespace rayfarm {
namespace HWY_NAMESPACE {

/// One that was built before: as the scene holds it.
class BuiltTree {
 public:
  using Node = const OctreeNode;
  BuiltTree(const Scene& scene, const Octree& octree)
      : nodes_(scene.octree_nodes.subspan(octree.first_node, octree.node_count)),
        cells_(scene.octree_cells.subspan(octree.first_cell, octree.cell_count)),
        table_(scene.octree_hash.subspan(octree.first_place, octree.place_count)),
        pointers_(scene.primitive_pointers) {}
  Node* root() const { return nodes_.data(); }
  static const OctreeNode& cube_of(Node& node) { return node; }
  static bool is_divided(Node& node) { return node.is_divided != 0; }
  Node* child(Node& node) const { return at(node.child); }
  Node* sibling(Node& node) const { return at(node.sibling); }

  /// What the cell of a node with this name lists.
  template <typename Search>
  HWY_INLINE CellList list(Node& node, uint64_t name, Search& search) const {
    if (table_.empty()) return list_of(cells_[node.child]);
    uint32_t i = table_[name % table_.size()];
    while (i != kNone) {
      if constexpr (Search::kCounts) search.count_chain_step();
      if (cells_[i].name == name) return list_of(cells_[i]);
      i = cells_[i].next;
    }
    return {};
  }

 private:
  Node* at(uint32_t index) const { return index == kNone ? nullptr : &nodes_[index]; }
  CellList list_of(const OctreeCell& cell) const {
    return pointers_.subspan(cell.first_pointer, cell.pointer_count);
  }
  std::span<const OctreeNode> nodes_;
  std::span<const OctreeCell> cells_;
  std::span<const uint32_t> table_;
  std::span<const PrimitivePointer> pointers_;
};

/// One that is built while rays are traced.
class GrowingTree {
 public:
  using Node = GrownNode;
  GrowingTree(const Scene& scene, const Octree& octree, GrownOctree& grown)
      : scene_(scene), octree_(octree), grown_(grown) {}
  Node* root() const { return grown_.root; }
  static const OctreeNode& cube_of(Node& node) { return node.cube; }
  bool is_divided(Node& node) const {
    GrownNode::State state = node.state.load(std::memory_order_acquire);
    if (HWY_UNLIKELY(state == GrownNode::State::open)) state = enter_open_node(scene_, octree_, grown_, node);
    return state == GrownNode::State::divided;
  }
  static Node* child(Node& node) { return node.child; }
  static Node* sibling(Node& node) { return node.sibling; }

  template <typename Search>
  HWY_INLINE CellList list(Node& node, uint64_t name, Search& search) const {
    if (grown_.table.empty()) return node.primitives;
    const Node* cell = grown_.table[name % grown_.table.size()].load(std::memory_order_acquire);
    for (; cell; cell = cell->next) {
      if constexpr (Search::kCounts) search.count_chain_step();
      if (cell->name == name) return cell->primitives;
    }
    return {};
  }

 private:
  const Scene& scene_;
  const Octree& octree_;
  GrownOctree& grown_;
};

/// The cells that a ray passes, one after the other. Its place is a point in the cell, counted in the
/// octree's units; along each axis it only ever moves as the ray does, so that the walk ends, and lies off
/// the ray by no more than the smallest cell and rounding.
template <typename Search, typename Tree>
class OctreeWalk {
  using Node = typename Tree::Node;

 public:
  /// `entry`: how far the ray goes to be inside.
  HWY_INLINE OctreeWalk(const Octree& octree, const Tree& tree, const PrimitiveRay& ray, double entry,
                        Search& search)
      : octree_(octree), tree_(tree), ray_(ray), search_(search) {
    path_[0] = tree.root();
    for (size_t axis = 0; axis < 3; ++axis)
      place_[axis] = static_cast<uint32_t>(std::clamp(along(axis, entry), 0.0, octree.size - 1.0));
    t_ = entry;
    count_node();
    descend();
  }

  HWY_INLINE CellList list() const {
    return is_empty_ ? CellList{} : tree_.list(*path_[depth_], name_, search_);
  }

  /// How far the ray is when it leaves the cell.
  double exit() const { return *std::min_element(exits_.begin(), exits_.end()); }

  /// False: the ray leaves the octree, or never leaves the cell.
  HWY_INLINE bool advance() {
    const double exit = this->exit();
    if (!std::isfinite(exit)) return false;
    t_ = std::max(t_, exit);
    const std::array<uint32_t, 3> before = place_;
    // To a point beyond every face that the exit lies on; a DDA crosses one.
    bool is_across = false;
    for (size_t axis = 0; axis < 3; ++axis)
      if (exits_[axis] > exit || (is_across && octree_.next == OctreeNext::dda)) {
        follow_ray(axis);
      } else {
        if (!cross_face(axis)) return false;
        is_across = true;
      }
    find_ancestor(before);
    descend();
    return true;
  }

 private:
  /// In units from the cube's corner, not below 0; 0 where a damaged scene's numbers are too large for any.
  double along(size_t i, double t) const {
    const auto axis = static_cast<int>(i);
    return std::max(0.0,
                    std::floor((ray_.origin[i] + t * ray_.direction[i] - octree_.low[axis]) / octree_.unit));
  }

  /// By half the smallest edge. False: out of the octree.
  HWY_INLINE bool cross_face(size_t axis) {
    if (ray_.direction[axis] > 0) {
      place_[axis] = low_[axis] + size_ + 1;
      return place_[axis] < octree_.size;
    }
    if (low_[axis] == 0) return false;
    place_[axis] = low_[axis] - 1;
    return true;
  }

  /// Inside the cell, which the ray leaves elsewhere.
  HWY_INLINE void follow_ray(size_t axis) {
    if (ray_.direction[axis] == 0) return;
    const bool is_forward = ray_.direction[axis] > 0;
    const double first = is_forward ? place_[axis] : low_[axis],
                 last = is_forward ? low_[axis] + size_ - 1 : place_[axis];
    place_[axis] = static_cast<uint32_t>(std::clamp(along(axis, t_), first, last));
  }

  /// Goes to a node that holds the place.
  HWY_INLINE void find_ancestor(const std::array<uint32_t, 3>& before) {
    size_t to = 0;
    switch (octree_.next) {
      case OctreeNext::root:
        count_node();
        break;
      case OctreeNext::walk:
        to = is_empty_ ? depth_ : depth_ - 1;
        for (;; --to) {
          count_node();
          if (to == 0 || is_in(Tree::cube_of(*path_[to]))) break;
        }
        break;
      case OctreeNext::dda: {
        // All nodes above the highest bit in which the places differ are the same.
        uint32_t different = 0;
        for (size_t axis = 0; axis < 3; ++axis) different |= before[axis] ^ place_[axis];
        to = static_cast<size_t>(std::bit_width(octree_.size) - 1 - std::bit_width(different));
        count_node();
        break;
      }
    }
    name_ >>= 3 * (depth_ + (is_empty_ ? 1 : 0) - to);
    depth_ = to;
  }

  bool is_in(const OctreeNode& node) const {
    for (size_t axis = 0; axis < 3; ++axis)
      if (place_[axis] < node.center[axis] - node.size / 2 ||
          place_[axis] >= node.center[axis] + node.size / 2)
        return false;
    return true;
  }

  /// From a node that holds the place to the cell: undivided, or an octant without data.
  HWY_INLINE void descend() {
    Node* node = path_[depth_];
    is_empty_ = false;
    while (tree_.is_divided(*node)) {
      const OctreeNode& cube = Tree::cube_of(*node);
      const uint32_t octant = octant_of(cube, place_);
      name_ = 8 * name_ + octant;
      Node* child = tree_.child(*node);
      for (; child; child = tree_.sibling(*child)) {
        count_node();
        if (octant_of(cube, Tree::cube_of(*child).center) == octant) break;
      }
      if (!child) {
        is_empty_ = true;
        for (size_t axis = 0; axis < 3; ++axis)
          low_[axis] = octant >> axis & 1 ? cube.center[axis] : cube.center[axis] - cube.size / 2;
        set_exits(cube.size / 2);
        return;
      }
      path_[++depth_] = child;
      node = child;
    }
    const OctreeNode& cube = Tree::cube_of(*node);
    for (size_t axis = 0; axis < 3; ++axis) low_[axis] = cube.center[axis] - cube.size / 2;
    set_exits(cube.size);
  }

  HWY_INLINE void set_exits(uint32_t size) {
    size_ = size;
    for (size_t i = 0; i < 3; ++i) {
      const auto axis = static_cast<int>(i);
      const uint32_t ahead = ray_.direction[i] > 0 ? size : 0;
      exits_[i] = distance_to_plane(ray_, i, octree_.low[axis] + octree_.unit * (low_[i] + ahead));
    }
  }

  HWY_INLINE void count_node() {
    if constexpr (Search::kCounts) search_.count_tree_node();
  }

  const Octree& octree_;
  const Tree tree_;
  const PrimitiveRay& ray_;
  Search& search_;
  double t_;                                      ///< where the ray is
  std::array<uint32_t, 3> place_;                 ///< the point that it stands for
  std::array<Node*, kMostOctreeDepth + 1> path_;  ///< nodes from the root to the cell's, or its parent
  size_t depth_ = 0;                              ///< of the last
  uint64_t name_ = 1;                             ///< the cell's
  bool is_empty_ = false;                         ///< the cell has no node
  std::array<uint32_t, 3> low_;                   ///< its corner
  uint32_t size_;                                 ///< its edges
  std::array<double, 3> exits_;                   ///< where the ray crosses the planes of faces ahead
};

template <typename Search>
HWY_NOINLINE bool search_octree(const Scene& scene, const Collection& collection, const PrimitiveRay& ray,
                                uint32_t instance, Search& search) {
  const Octree& octree = scene.octrees[collection.octree];
  const auto search_tree = [&](const auto& tree) HWY_ATTR {
    return search_cells(collection, octree.box(), ray, instance, search,
                        [&](double entry) HWY_ATTR { return OctreeWalk(octree, tree, ray, entry, search); });
  };
  GrownOctree* const grown = scene.tracing ? scene.tracing->octrees[collection.octree].get() : nullptr;
  return grown ? search_tree(GrowingTree(scene, octree, *grown)) : search_tree(BuiltTree(scene, octree));
}

}  // namespace HWY_NAMESPACE
}  // namespace rayfarm
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
