#include "common/scene/hierarchy_checks.h"

#include <bit>
#include <cmath>

#include "common/scene/bounding_checks.h"
#include "common/scene/check_tools.h"
#include "common/scene/octant_checks.h"

namespace rayfarm {
namespace {

/// Trees of nodes whose leaves lie in the arrays.
class TreeChecks {
 public:
  TreeChecks(const Scene& s, std::span<const VolumeNode> nodes)
      : nodes_(nodes),
        levels_(nodes.size(), 0),
        triangle_blocks_(s.triangle_blocks.size(), "a leaf's triangles"),
        sphere_blocks_(s.sphere_blocks.size(), "a leaf's spheres"),
        leaf_primitives_(s.leaf_primitives.size(), "a leaf's primitives"),
        leaf_instances_(s.leaf_instances.size(), "a leaf's instances") {}

  /// Roots first, then all that is below them.
  void check_root(const ChildRef& root, bool of_objects) { check(root, of_objects, 1); }
  void check_nodes(bool of_objects) {
    const VolumeNode unused = make_empty_node();
    for (size_t i = 0; i < nodes_.size(); ++i) {
      require(levels_[i] > 0, "a node that is nobody's child");
      for (size_t slot = 0; slot < 8; ++slot) {
        const ChildRef& child = nodes_[i].children[slot];
        // Children stand after their parents, so a walk always ends.
        require(child.kind() != ChildKind::inner || child.first > i, "a node's child");
        check(child, of_objects, levels_[i] + 1);
        if (child.kind() == ChildKind::empty)  // its box must let no ray in
          for (size_t end = 0; end < 2; ++end)
            for (size_t axis = 0; axis < 3; ++axis)
              require(nodes_[i].planes[end][axis][slot] == unused.planes[end][axis][slot],
                      "an unused child's box");
      }
    }
  }

 private:
  void check(const ChildRef& child, bool of_objects, int level) {
    const ChildKind kind = child.kind();
    require(kind <= ChildKind::inner || (kind == ChildKind::instances) == of_objects,
            "a leaf in the wrong part of the hierarchy");
    switch (kind) {
      case ChildKind::empty:
        require(child.first == 0 && child.count() == 0, "an unused child");
        return;
      case ChildKind::inner:
        // One parent each, or the ways down would multiply; and no more levels than a traverser can remember.
        require(child.first < nodes_.size() && levels_[child.first] == 0 && level < kMostHierarchyLevels,
                "a node's child");
        levels_[child.first] = level;
        return;
      case ChildKind::triangles:
        return triangle_blocks_.take(child.first, child.count());
      case ChildKind::spheres:
        return sphere_blocks_.take(child.first, child.count());
      case ChildKind::mixed:
        return leaf_primitives_.take(child.first, child.count());
      case ChildKind::instances:
        return leaf_instances_.take(child.first, child.count());
    }
    require(false, "a child's kind");
  }

  std::span<const VolumeNode> nodes_;
  std::vector<int> levels_;  ///< of each node; 0: not met yet
  OwnRanges triangle_blocks_, sphere_blocks_, leaf_primitives_, leaf_instances_;
};

/// A range of an array that may have several owners.
void check_range(size_t size, uint64_t first, uint64_t count, const char* what) {
  require(first <= size && count <= size - first, what);
}

void check_grid(const Scene& s, const Grid& grid) {
  uint64_t count = 1;
  for (const uint32_t n : grid.cells) {
    require(n > 0 && n <= kMostCells, "a grid's cells");
    count *= n;
  }
  for (int axis = 0; axis < 3; ++axis)
    require(std::isfinite(grid.low[axis]) && std::isfinite(grid.cell[axis]) && grid.cell[axis] > 0,
            "a grid's box");
  check_range(s.grid_cells.size(), grid.first_cell, count + 1, "a grid's cells");
  const auto ends = s.grid_cells.subspan(grid.first_cell, count + 1);
  require(ends.back() <= s.primitive_pointers.size(), "a cell's list");
  for (size_t i = 0; i < count; ++i) require(ends[i] <= ends[i + 1], "a cell's list");
}

/// Its cube is one of the parent's eight.
void check_octant(const OctreeNode& child, const OctreeNode& parent) {
  require(child.size == parent.size / 2, "an octree's octant");
  for (size_t axis = 0; axis < 3; ++axis)
    require(child.center[axis] == parent.center[axis] - child.size / 2 ||
                child.center[axis] == parent.center[axis] + child.size / 2,
            "an octree's octant");
}

/// Ways down end, and so do those along siblings and chains: what is next stands behind.
void check_octree(const Scene& s, const Octree& octree) {
  require(std::isfinite(octree.unit) && octree.unit > 0, "an octree's cube");
  for (int axis = 0; axis < 3; ++axis) require(std::isfinite(octree.low[axis]), "an octree's cube");
  require(std::has_single_bit(octree.size) && octree.size >= 2 && octree.size <= 2u << kMostOctreeDepth,
          "an octree's size");
  require(octree.next <= OctreeNext::dda, "an octree's way to the next cell");
  check_range(s.octree_nodes.size(), octree.first_node, octree.node_count, "an octree's nodes");
  check_range(s.octree_cells.size(), octree.first_cell, octree.cell_count, "an octree's cells");
  check_range(s.octree_hash.size(), octree.first_place, octree.place_count, "an octree's hash table");
  require(octree.max_primitives > 0, "an octree's cut");
  require(octree.build == OctreeBuild::before ||
              (octree.build == OctreeBuild::tracing && octree.node_count == 1 && octree.cell_count == 1),
          "an octree that is built while tracing");
  const auto nodes = s.octree_nodes.subspan(octree.first_node, octree.node_count);
  require(!nodes.empty() && nodes[0].size == octree.size && nodes[0].sibling == kNone, "an octree's root");
  for (const uint32_t center : nodes[0].center) require(center == octree.size / 2, "an octree's root");
  std::vector<bool> is_child(nodes.size());
  for (size_t i = 0; i < nodes.size(); ++i) {
    const OctreeNode& node = nodes[i];
    if (node.is_divided == 0) {
      require(octree.place_count > 0 ? node.child == kNone : node.child < octree.cell_count,
              "an octree's cell");
      continue;
    }
    require(node.size >= 4, "an octree's cell that is too small to be divided");
    size_t previous = i;
    for (uint32_t child = node.child; child != kNone; previous = child, child = nodes[child].sibling) {
      require(child < nodes.size() && child > previous && !is_child[child], "an octree's node");
      is_child[child] = true;
      check_octant(nodes[child], node);
    }
  }
  const auto cells = s.octree_cells.subspan(octree.first_cell, octree.cell_count);
  for (size_t i = 0; i < cells.size(); ++i) {
    check_range(s.primitive_pointers.size(), cells[i].first_pointer, cells[i].pointer_count, "a cell's list");
    require(cells[i].next == kNone || (cells[i].next > i && cells[i].next < cells.size()),
            "a chain of an octree's hash table");
  }
  for (const uint32_t cell : s.octree_hash.subspan(octree.first_place, octree.place_count))
    require(cell == kNone || cell < cells.size(), "an octree's hash table");
}

void check_pointers(const Scene& s) {
  for (const PrimitivePointer p : s.primitive_pointers) {
    const uint32_t place = p.place();
    switch (p.kind()) {
      case PointerKind::triangle:
        require(place / 8 < s.triangle_blocks.size() &&
                    s.triangle_blocks[place / 8].primitives[place % 8] != kNoPrimitive,
                "a cell's triangle");
        continue;
      case PointerKind::sphere:
        require(place / 8 < s.sphere_blocks.size() && s.sphere_blocks[place / 8].spheres[place % 8] != kNone,
                "a cell's sphere");
        continue;
      case PointerKind::other:
        require(place < s.leaf_primitives.size(), "a cell's primitive");
        continue;
    }
    require(false, "a cell's primitive");
  }
}

void check_collection(const Scene& s, const Collection& c, TreeChecks& volumes) {
  require(c.structure <= Structure::octants, "a collection's structure");
  require((c.structure == Structure::octants) == (c.octants != kNone) &&
              (c.octants == kNone || c.octants < s.octant_trees.size()),
          "a collection's octants");
  require((c.structure == Structure::object) == (c.tree != kNone) &&
              (c.tree == kNone || c.tree < s.bounding_trees.size()),
          "a collection's tree");
  require((c.structure == Structure::regular) == (c.grid != kNone) &&
              (c.grid == kNone || c.grid < s.grids.size()),
          "a collection's grid");
  require((c.structure == Structure::adaptive) == (c.octree != kNone) &&
              (c.octree == kNone || c.octree < s.octrees.size()),
          "a collection's octree");
  volumes.check_root(c.root, false);
  check_range(s.triangle_blocks.size(), c.first_triangle_block, c.triangle_block_count,
              "a collection's triangles");
  check_range(s.sphere_blocks.size(), c.first_sphere_block, c.sphere_block_count, "a collection's spheres");
  check_range(s.leaf_primitives.size(), c.first_leaf_primitive, c.leaf_primitive_count,
              "a collection's primitives");
}

void check_collections(const Scene& s, TreeChecks& volumes) {
  for (const Collection& c : s.collections) check_collection(s, c, volumes);
  for (const Grid& grid : s.grids) check_grid(s, grid);
  for (const Octree& octree : s.octrees) check_octree(s, octree);
  check_octant_trees(s);
  check_pointers(s);
}

/// Collections in collections: a ray's way through them ends, and soon. Trees, grids, octrees and
/// octants are known to be whole.
class NestingChecks {
 public:
  explicit NestingChecks(const Scene& s)
      : s_(s),
        inside_(s.collections.size()),
        is_grid_owned_(s.grids.size()),
        is_octree_owned_(s.octrees.size()),
        is_octant_tree_owned_(s.octant_trees.size()) {}

  /// What is in collection `index` stands before it, so it is checked already; kNone: a part's own.
  void check(const Collection& c, uint32_t index) {
    Inside inside;
    for (const PrimitiveId id : s_.leaf_primitives.subspan(c.first_leaf_primitive, c.leaf_primitive_count)) {
      if (id.kind() != PrimitiveKind::collection) continue;
      require(id.index() < s_.collections.size() && id.index() < index, "a collection in a collection");
      inside.levels = std::max(inside.levels, 1 + inside_[id.index()].levels);
      inside.searches += 1 + inside_[id.index()].searches;
      require(inside.levels <= kMostLevels && inside.searches <= kMostSearches, "collections in each other");
    }
    const auto take = [&](uint64_t searches) { inside.searches = std::max(inside.searches, searches); };
    check_tree(c);
    if (c.grid != kNone) {
      require(!is_grid_owned_[c.grid], "a collection's grid");
      is_grid_owned_[c.grid] = true;
      const Grid& grid = s_.grids[c.grid];
      const auto ends = s_.grid_cells.subspan(grid.first_cell, grid.cell_count() + 1);
      for (size_t i = 0; i + 1 < ends.size(); ++i) take(check_list(c, ends[i], ends[i + 1] - ends[i]));
    }
    if (c.octree != kNone) {
      require(!is_octree_owned_[c.octree], "a collection's octree");
      is_octree_owned_[c.octree] = true;
      const Octree& octree = s_.octrees[c.octree];
      for (const OctreeCell& cell : s_.octree_cells.subspan(octree.first_cell, octree.cell_count))
        take(check_list(c, cell.first_pointer, cell.pointer_count));
    }
    if (c.octants != kNone) {
      require(!is_octant_tree_owned_[c.octants], "a collection's octants");
      is_octant_tree_owned_[c.octants] = true;
      const OctantTree& tree = s_.octant_trees[c.octants];
      for (const OctantVolume& volume : s_.octant_volumes.subspan(tree.first_volume, tree.volume_count))
        if (volume.is_leaf()) take(check_list(c, volume.first, volume.pointer_count));
    }
    if (index != kNone) inside_[index] = inside;
  }

 private:
  static constexpr size_t kMostLevels = 66;  ///< objects in YAML nest 64 deep
  static constexpr uint64_t kMostSearches = 1 << 24;
  struct Inside {
    size_t levels = 0;      ///< of collections
    uint64_t searches = 0;  ///< that one search may come to
  };

  /// What it reaches are its own primitives, among which the collections in it were looked at.
  void check_own(const Collection& c, uint64_t first, uint64_t count) const {
    require(first >= c.first_leaf_primitive &&
                first + count <= uint64_t{c.first_leaf_primitive} + c.leaf_primitive_count,
            "a collection's primitives");
  }
  void check_tree(const Collection& c) const {
    std::vector<ChildRef> open{c.root};
    while (!open.empty()) {
      const ChildRef child = open.back();
      open.pop_back();
      if (child.kind() == ChildKind::mixed) check_own(c, child.first, child.count());
      if (child.kind() != ChildKind::inner) continue;
      for (const ChildRef& below : s_.nodes[child.first].children) open.push_back(below);
    }
  }
  /// Returns how many searches the list may come to.
  uint64_t check_list(const Collection& c, uint32_t first, uint32_t count) const {
    const std::array<uint64_t, 3> begins{8 * uint64_t{c.first_triangle_block},
                                         8 * uint64_t{c.first_sphere_block}, c.first_leaf_primitive},
        counts{8 * uint64_t{c.triangle_block_count}, 8 * uint64_t{c.sphere_block_count},
               c.leaf_primitive_count};  // in the order of PointerKind
    uint64_t searches = 0;
    for (const PrimitivePointer& p : s_.primitive_pointers.subspan(first, count)) {
      const auto kind = static_cast<size_t>(p.kind());
      require(p.place() >= begins[kind] && p.place() - begins[kind] < counts[kind],
              "a collection's primitives");
      if (p.kind() != PointerKind::other) continue;
      const PrimitiveId id = s_.leaf_primitives[p.place()];
      if (id.kind() == PrimitiveKind::collection) searches += 1 + inside_[id.index()].searches;
      require(searches <= kMostSearches, "collections in each other");
    }
    return searches;
  }

  const Scene& s_;
  std::vector<Inside> inside_;  ///< by collection
  std::vector<bool> is_grid_owned_, is_octree_owned_, is_octant_tree_owned_;
};

}  // namespace

void check_hierarchy(const Scene& s) {
  TreeChecks volumes(s, s.nodes), fixed(s, s.fixed_nodes), moving(s, s.moving_nodes);
  OwnRanges triangles(s.triangle_blocks.size(), "a part's triangles"),
      spheres(s.sphere_blocks.size(), "a part's spheres"),
      primitives(s.leaf_primitives.size(), "a part's primitives");
  check_collections(s, volumes);
  for (const Part& part : s.parts) {
    check_collection(s, part.collection, volumes);
    triangles.take(part.first_triangle_block, part.triangle_block_count);
    spheres.take(part.first_sphere_block, part.sphere_block_count);
    primitives.take(part.first_leaf_primitive, part.leaf_primitive_count);
  }
  check_bounding_trees(s);
  volumes.check_nodes(false);
  NestingChecks nesting(s);
  for (uint32_t i = 0; i < s.collections.size(); ++i) nesting.check(s.collections[i], i);
  for (const Part& part : s.parts) nesting.check(part.collection, kNone);
  fixed.check_root(s.head().fixed_root, true);
  fixed.check_nodes(true);
  moving.check_root(s.head().moving_root, true);
  moving.check_nodes(true);
  for (const uint32_t i : s.leaf_instances) require(i < s.instances.size(), "a leaf's instance");
}

/// What the leaves hold. A lane without a primitive holds numbers that no test accepts.
void check_leaves(const Scene& s) {
  for (const TriangleBlock& block : s.triangle_blocks)
    for (size_t lane = 0; lane < 8; ++lane) {
      const PrimitiveId p = block.primitives[lane];
      if (p != kNoPrimitive) {
        require(exists(s, p, PrimitiveKind::triangle) || exists(s, p, PrimitiveKind::polygon) ||
                    exists(s, p, PrimitiveKind::face),
                "a triangle");
        continue;
      }
      for (const auto& vertex : block.vertices)
        for (const auto& axis : vertex) require(std::isnan(axis[lane]), "an unused triangle");
    }
  for (const SphereBlock& block : s.sphere_blocks)
    for (size_t lane = 0; lane < 8; ++lane) {
      if (block.spheres[lane] != kNone) {
        require(block.spheres[lane] < s.spheres.size(), "a sphere");
        continue;
      }
      for (const auto& axis : block.center) require(std::isnan(axis[lane]), "an unused sphere");
      require(std::isnan(block.radius[lane]), "an unused sphere");
    }
  for (const PrimitiveId p : s.leaf_primitives)
    require(exists(s, p, PrimitiveKind::polygon) || exists(s, p, PrimitiveKind::quadric) ||
                exists(s, p, PrimitiveKind::collection),
            "a leaf's primitive");
}

}  // namespace rayfarm
