#include "common/hierarchy/octree.h"

#include "common/hierarchy/cells.h"

namespace rayfarm {
namespace {

/// A node whose cell may still be divided.
struct OpenNode {
  uint32_t node;
  uint64_t name;
  std::vector<uint32_t> primitives;  ///< that have a part in it
};

class Builder {
 public:
  Builder(const PrimitiveSource& source, std::span<const PrimitivePointer> pointers,
          const BuildOptions& options, SceneArrays<GrowingArray>& arrays)
      : source_(source), pointers_(pointers), options_(options), arrays_(arrays) {
    const Box box = thick_bounds(source);
    const double half = 0.5 * max_component(box.extent());
    octree_.low = box.center() - Vec3(half);
    octree_.size = 2u << options.octree_depth;
    octree_.unit = 2 * half / octree_.size;
    octree_.next = options.octree_next;
    octree_.max_primitives = options.max_primitives;
    octree_.build = options.octree_build;
    octree_.first_node = static_cast<uint32_t>(arrays.octree_nodes.size());
    octree_.first_cell = static_cast<uint32_t>(arrays.octree_cells.size());
    octree_.first_place = static_cast<uint32_t>(arrays.octree_hash.size());
    for (uint32_t i = 0; i < source.size(); ++i) bounds_.push_back(source.bounds(i));
  }

  uint32_t build() {
    OctreeNode root;
    root.size = octree_.size;
    root.center.fill(octree_.size / 2);
    arrays_.octree_nodes.push_back(root);
    OpenNode all{0, 1, {}};
    for (uint32_t i = 0; i < source_.size(); ++i) all.primitives.push_back(i);
    pointer_count_ = all.primitives.size();
    if (options_.progress) options_.progress->total += pointer_count_;
    std::vector<OpenNode> level;
    level.push_back(std::move(all));
    while (!level.empty()) {
      std::vector<OpenNode> next;
      for (OpenNode& open : level)
        if (octree_.build == OctreeBuild::before &&
            is_to_be_divided(octree_, node(open.node).size, open.primitives.size(), pointer_count_,
                             source_.size()))
          divide(open, next);
        else
          close(open);
      level = std::move(next);
    }
    octree_.node_count = static_cast<uint32_t>(arrays_.octree_nodes.size()) - octree_.first_node;
    octree_.cell_count = static_cast<uint32_t>(arrays_.octree_cells.size()) - octree_.first_cell;
    if (options_.octree_data == OctreeData::hash) fill_hash_table();
    arrays_.octrees.push_back(octree_);
    return static_cast<uint32_t>(arrays_.octrees.size() - 1);
  }

 private:
  OctreeNode& node(uint32_t index) { return arrays_.octree_nodes[octree_.first_node + index]; }

  /// Octants without data have no node.
  void divide(const OpenNode& open, std::vector<OpenNode>& next) {
    throw_if_stopped(options_.stop);
    const OctreeNode parent = node(open.node);
    node(open.node).is_divided = 1;
    const size_t pointers_before = pointer_count_;
    pointer_count_ -= open.primitives.size();
    uint32_t previous = kNone;
    for (uint32_t octant = 0; octant < 8; ++octant) {
      const OctreeNode child = make_octant(parent, octant);
      std::vector<uint32_t> inside = those_in_octant(octree_, child, source_, bounds_, open.primitives);
      if (inside.empty()) continue;
      const auto index = static_cast<uint32_t>(arrays_.octree_nodes.size()) - octree_.first_node;
      arrays_.octree_nodes.push_back(child);
      (previous == kNone ? node(open.node).child : node(previous).sibling) = index;
      previous = index;
      pointer_count_ += inside.size();
      next.push_back({index, 8 * open.name + octant, std::move(inside)});
    }
    if (options_.progress) options_.progress->total += pointer_count_ - pointers_before;
  }

  void close(const OpenNode& open) {
    check_count(arrays_.primitive_pointers.size() + open.primitives.size(),
                "pointers from cells to primitives", "--max-primitives");
    OctreeCell cell;
    cell.name = open.name;
    cell.first_pointer = static_cast<uint32_t>(arrays_.primitive_pointers.size());
    cell.pointer_count = static_cast<uint32_t>(open.primitives.size());
    for (const uint32_t i : open.primitives) arrays_.primitive_pointers.push_back(pointers_[i]);
    if (options_.octree_data == OctreeData::pointers)
      node(open.node).child = static_cast<uint32_t>(arrays_.octree_cells.size()) - octree_.first_cell;
    arrays_.octree_cells.push_back(cell);
    if (options_.progress) options_.progress->done += open.primitives.size();
  }

  void fill_hash_table() {
    octree_.place_count = options_.octree_hash;
    check_count(arrays_.octree_hash.size() + options_.octree_hash, "places of hash tables", "--octree-hash");
    arrays_.octree_hash.resize(octree_.first_place + octree_.place_count, kNone);
    for (uint32_t i = octree_.cell_count; i-- > 0;) {  // from behind: chains lead onward
      OctreeCell& cell = arrays_.octree_cells[octree_.first_cell + i];
      uint32_t& first = arrays_.octree_hash[octree_.first_place + cell.name % octree_.place_count];
      cell.next = first;
      first = i;
    }
  }

  const PrimitiveSource& source_;
  std::span<const PrimitivePointer> pointers_;
  const BuildOptions& options_;
  SceneArrays<GrowingArray>& arrays_;
  Octree octree_;
  std::vector<Box> bounds_;  ///< of the primitives
  size_t pointer_count_ = 0;
};

}  // namespace

bool is_to_be_divided(const Octree& octree, uint32_t size, size_t primitives, size_t pointers, size_t all) {
  constexpr size_t kMostPointersMore = 4096;
  return primitives > octree.max_primitives && size > 2 &&
         pointers <= kMostPointersForEach * all + kMostPointersMore;
}

OctreeNode make_octant(const OctreeNode& node, uint32_t octant) {
  OctreeNode part;
  part.size = node.size / 2;
  for (size_t axis = 0; axis < 3; ++axis)
    part.center[axis] =
        octant >> axis & 1 ? node.center[axis] + part.size / 2 : node.center[axis] - part.size / 2;
  return part;
}

std::vector<uint32_t> those_in_octant(const Octree& octree, const OctreeNode& octant,
                                      const PrimitiveSource& source, std::span<const Box> bounds,
                                      std::span<const uint32_t> primitives) {
  const Vec3 margin = with_margin(octree.box()).hi - octree.box().hi, half(octant.size / 2),
             center(octant.center[0], octant.center[1], octant.center[2]);
  const Box cell{octree.low + octree.unit * (center - half) - margin,
                 octree.low + octree.unit * (center + half) + margin};
  std::vector<uint32_t> inside;
  for (const uint32_t i : primitives)
    if (!intersection(bounds[i], cell).is_empty() && !source.clipped(i, cell).is_empty()) inside.push_back(i);
  return inside;
}

uint32_t build_octree(const PrimitiveSource& source, std::span<const PrimitivePointer> pointers,
                      const BuildOptions& options, SceneArrays<GrowingArray>& arrays) {
  return Builder(source, pointers, options, arrays).build();
}

}  // namespace rayfarm
