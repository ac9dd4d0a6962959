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
    octree_.first_node = static_cast<uint32_t>(arrays.octree_nodes.size());
    octree_.first_cell = static_cast<uint32_t>(arrays.octree_cells.size());
    octree_.first_place = static_cast<uint32_t>(arrays.octree_hash.size());
    margin_ = with_margin(octree_.box()).hi - octree_.box().hi;
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
        if (is_to_be_divided(open))
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

  bool is_to_be_divided(const OpenNode& open) {
    constexpr size_t kMostPointersMore = 4096;
    return open.primitives.size() > options_.max_primitives && node(open.node).size > 2 &&
           pointer_count_ <= kMostPointersForEach * source_.size() + kMostPointersMore;
  }

  /// Octants without data have no node.
  void divide(const OpenNode& open, std::vector<OpenNode>& next) {
    throw_if_stopped(options_.stop);
    const OctreeNode parent = node(open.node);
    node(open.node).is_divided = 1;
    const size_t pointers_before = pointer_count_;
    pointer_count_ -= open.primitives.size();
    uint32_t previous = kNone;
    for (uint32_t octant = 0; octant < 8; ++octant) {
      OctreeNode child;
      child.size = parent.size / 2;
      for (size_t axis = 0; axis < 3; ++axis)
        child.center[axis] =
            octant >> axis & 1 ? parent.center[axis] + child.size / 2 : parent.center[axis] - child.size / 2;
      std::vector<uint32_t> inside = those_in(box_of(child), open.primitives);
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

  Box box_of(const OctreeNode& node) const {
    const Vec3 center(node.center[0], node.center[1], node.center[2]), half(node.size / 2);
    return {octree_.low + octree_.unit * (center - half) - margin_,
            octree_.low + octree_.unit * (center + half) + margin_};
  }

  std::vector<uint32_t> those_in(const Box& cell, const std::vector<uint32_t>& primitives) const {
    std::vector<uint32_t> inside;
    for (const uint32_t i : primitives)
      if (!intersection(bounds_[i], cell).is_empty() && !source_.clipped(i, cell).is_empty())
        inside.push_back(i);
    return inside;
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
  Vec3 margin_{0};
  std::vector<Box> bounds_;  ///< of the primitives
  size_t pointer_count_ = 0;
};

}  // namespace

uint32_t build_octree(const PrimitiveSource& source, std::span<const PrimitivePointer> pointers,
                      const BuildOptions& options, SceneArrays<GrowingArray>& arrays) {
  return Builder(source, pointers, options, arrays).build();
}

}  // namespace rayfarm
