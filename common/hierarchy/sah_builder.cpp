// The surface area heuristic in two steps: a binary tree by binned splits (Wald 2007), then the best collapse
// of it to eight children a node by dynamic programming (Ylitie, Karras, Laine 2017, section 3.1).
#include <algorithm>
#include <cmath>
#include <future>
#include <memory>

#include "common/hierarchy/builder.h"
#include "common/hierarchy/spatial_splits.h"
#include "common/parallel/parallel_for.h"

namespace rayfarm {
namespace {

constexpr size_t kBins = 16;
constexpr size_t kSlots = 8;
/// From this depth on data are halved by number, which ends within 30 levels.
constexpr int kMostSahSplits = kMostHierarchyLevels - 34;
/// Parts with fewer references are built by one thread.
constexpr size_t kLeastPerTask = 1 << 14;
/// Smaller parts take too little time to ask whether to stop.
constexpr size_t kLeastPerLook = 1 << 12;
// The costs that the collapse weighs, in tests of one block of eight primitives (measured).
constexpr float kNodeCost = 1.0f;

/// What would fit into a leaf is still divided if its box is larger than this part of the whole one: such
/// leaves are few, and met by many rays.
constexpr float kLargeLeaf = 1e-3f;

/// cost[i]: of the best forest of at most i trees that holds a node's references.
using Costs = std::array<float, kSlots + 1>;

/// A node of the binary tree over references [first, first + count). 64 bytes.
struct BinaryNode {
  Bounds bounds;
  uint32_t first, count;
  uint32_t left;  ///< the right child is the next one; 0: not split
  bool is_leaf;   ///< one leaf costs less than children do
  /// split[i]: how many of the best forest's i trees are the left child's, 0 if one tree less is as good.
  std::array<uint8_t, kSlots + 1> split;
};

class SahBuilder {
 public:
  SahBuilder(LargeVector<PrimitiveReference> references, const PrimitiveSource& source,
             const BuildOptions& options, const LeafMaker& make_leaf, LargeVector<VolumeNode>& nodes)
      : references_(std::move(references)),
        spatial_(source, options.quality, references_),
        binary_(static_cast<BinaryNode*>(
            allocate_large((2 * (references_.size() + spatial_.budget()) - 1) * sizeof(BinaryNode)))),
        most_in_leaf_(options.max_primitives),
        make_leaf_(make_leaf),
        nodes_(nodes),
        progress_(options.progress),
        stop_(options.stop) {}

  ChildRef build() {
    const size_t cores = core_count();
    int task_levels = 0;  // four tasks a core, because they differ in length
    while (cores > 1 && (1u << task_levels) < 4 * cores) ++task_levels;
    Range all{0, static_cast<uint32_t>(references_.size()), 0, Bounds::none(), Bounds::none()};
    for (const PrimitiveReference& r : references_) {
      all.bounds.grow(r.lo.data(), r.hi.data());
      grow_centers(all.centers, r);
    }
    all.spare = static_cast<uint32_t>(spatial_.budget());
    references_.reserve(references_.size() + all.spare);  // no more than is wanted
    references_.resize(references_.size() + all.spare);
    split(0, all, 0, task_levels);
    return emit(0);
  }

 private:
  struct Range {
    uint32_t first, count;
    uint32_t spare;  ///< places behind them, for the second pieces of what a plane cuts
    Bounds bounds;
    Bounds centers;  ///< of lo + hi
  };
  struct Split {
    int axis = -1;
    size_t bin = 0;
    float cost = std::numeric_limits<float>::infinity();
    Bounds left, right;
  };

  static void grow_centers(Bounds& centers, const PrimitiveReference& r) {
    const std::array<float, 4> c{r.lo[0] + r.hi[0], r.lo[1] + r.hi[1], r.lo[2] + r.hi[2], 0};
    centers.grow(c.data(), c.data());
  }

  /// Where references fall on the axes of a range: bins of equal width over the centres.
  struct Binning {
    std::array<float, 3> origin, scale;
    explicit Binning(const Bounds& centers) {
      for (size_t axis = 0; axis < 3; ++axis) {
        origin[axis] = centers.lo[axis];
        const float extent = centers.hi[axis] - centers.lo[axis];
        scale[axis] = extent > 0 ? (static_cast<float>(kBins) * 0.9999f) / extent : 0;
        if (!std::isfinite(scale[axis])) scale[axis] = 0;
      }
    }
    size_t bin(const PrimitiveReference& r, size_t axis) const {
      // Not a number where coordinates are so large that there is no scale: then all fall into the first.
      const float at = std::max(0.0f, ((r.lo[axis] + r.hi[axis]) - origin[axis]) * scale[axis]);
      return static_cast<size_t>(static_cast<int>(at));
    }
  };

  Split best_split(const Range& range) const {
    struct Bin {
      Bounds bounds = Bounds::none();
      uint32_t count = 0;
    };
    const Binning binning(range.centers);
    std::array<std::array<Bin, kBins>, 3> bins;
    for (uint32_t i = range.first; i < range.first + range.count; ++i)
      for (size_t axis = 0; axis < 3; ++axis) {
        const PrimitiveReference& r = references_[i];
        Bin& bin = bins[axis][binning.bin(r, axis)];
        bin.bounds.grow(r.lo.data(), r.hi.data());
        ++bin.count;
      }
    Split best;
    for (size_t axis = 0; axis < 3; ++axis) {
      if (binning.scale[axis] == 0) continue;
      std::array<float, kBins> cost_above;  // of the bins from i on
      Bounds bounds = Bounds::none();
      uint32_t count = 0;
      for (size_t i = kBins; i-- > 1;) {
        bounds.grow(bins[axis][i].bounds);
        count += bins[axis][i].count;
        cost_above[i] = count > 0 ? bounds.area() * blocks_of(count) : 0;
      }
      bounds = Bounds::none();
      count = 0;
      for (size_t i = 1; i < kBins; ++i) {
        bounds.grow(bins[axis][i - 1].bounds);
        count += bins[axis][i - 1].count;
        if (count == 0 || count == range.count) continue;
        const float cost = bounds.area() * blocks_of(count) + cost_above[i];
        if (cost < best.cost) {
          best.cost = cost;
          best.axis = static_cast<int>(axis);
          best.bin = i;
        }
      }
    }
    if (best.axis < 0) return best;
    best.left = best.right = Bounds::none();
    const auto& row = bins[static_cast<size_t>(best.axis)];
    for (size_t i = 0; i < kBins; ++i) (i < best.bin ? best.left : best.right).grow(row[i].bounds);
    return best;
  }

  /// Divides a range in two; false if nothing parts it.
  bool divide(const Range& range, int depth, Range& left, Range& right) {
    left = right = {range.first, 0, 0, Bounds::none(), Bounds::none()};
    Split best;
    if (depth < kMostSahSplits) {
      best = best_split(range);
      if (divide_space(range, best, left, right)) return true;
    }
    const auto begin = references_.begin() + range.first, end = begin + range.count;
    auto middle = begin + range.count / 2;
    if (best.axis >= 0) {
      const Binning binning(range.centers);
      const auto axis = static_cast<size_t>(best.axis);
      middle = std::partition(begin, end,
                              [&](const PrimitiveReference& r) { return binning.bin(r, axis) < best.bin; });
      left.bounds = best.left;
      right.bounds = best.right;
    } else {
      size_t axis = 0;
      for (size_t i = 1; i < 3; ++i)
        if (range.centers.hi[i] - range.centers.lo[i] > range.centers.hi[axis] - range.centers.lo[axis])
          axis = i;
      if (!(range.centers.hi[axis] > range.centers.lo[axis])) return false;
      std::nth_element(begin, middle, end, [&](const PrimitiveReference& a, const PrimitiveReference& b) {
        const float x = a.lo[axis] + a.hi[axis], y = b.lo[axis] + b.hi[axis];
        return x != y ? x < y : a.primitive < b.primitive;
      });
      for (auto i = begin; i != end; ++i) (i < middle ? left : right).bounds.grow(i->lo.data(), i->hi.data());
    }
    left.count = static_cast<uint32_t>(middle - begin);
    right.count = range.count - left.count;
    set_apart(range.spare, left, right);
    return true;
  }

  /// Divides a range at a plane; false if that does not pay.
  bool divide_space(const Range& range, const Split& other, Range& left, Range& right) {
    if (range.spare == 0 || (other.axis >= 0 && !spatial_.is_promising(other.left, other.right)))
      return false;
    // What may stay one leaf must be better divided than that, too.
    const float undivided = range.count <= most_in_leaf_ ? range.bounds.area() * blocks_of(range.count)
                                                         : std::numeric_limits<float>::infinity();
    PrimitiveReference* const first = references_.data() + range.first;
    const SpatialSplits::Plane plane =
        spatial_.best_plane(std::span(first, range.count), range.bounds, range.spare);
    if (!(plane.cost < std::min(other.cost, undivided))) return false;
    const SpatialSplits::Sides sides = spatial_.divide(first, range.count, plane, range.spare);
    if (sides.left == 0 || sides.right == 0) return false;
    left.count = static_cast<uint32_t>(sides.left);
    right.count = static_cast<uint32_t>(sides.right);
    const uint32_t added = left.count + right.count - range.count;
    if (progress_) progress_->total += added;
    for (uint32_t i = 0; i < left.count + right.count; ++i)
      (i < left.count ? left : right).bounds.grow(first[i].lo.data(), first[i].hi.data());
    set_apart(range.spare - added, left, right);
    return true;
  }

  /// Gives each child its place, with a part of the spare ones by the area of what it holds, and bounds its
  /// centres.
  void set_apart(uint32_t spare, Range& left, Range& right) {
    right.first = left.first + left.count;
    double areas[2]{};
    for (uint32_t i = left.first; i < right.first + right.count; ++i) {
      const PrimitiveReference& r = references_[i];
      grow_centers((i < right.first ? left : right).centers, r);
      if (spare > 0) {
        const float x = r.hi[0] - r.lo[0], y = r.hi[1] - r.lo[1], z = r.hi[2] - r.lo[2];
        areas[i < right.first ? 0 : 1] += x * y + y * z + z * x;
      }
    }
    if (spare == 0) return;
    const double sum = areas[0] + areas[1];
    left.spare = sum > 0 ? static_cast<uint32_t>(std::lround(spare * (areas[0] / sum))) : 0;
    right.spare = spare - left.spare;
    // Their order does not matter: no more are moved than there is room to cross.
    const auto begin = references_.begin() + right.first;
    const uint32_t moved = std::min(left.spare, right.count);
    std::copy(begin, begin + moved, begin + right.count + left.spare - moved);
    right.first += left.spare;
  }

  /// Returns the node's costs.
  Costs split(uint32_t index, const Range& range, int depth, int task_levels) {
    if (range.count >= kLeastPerLook) throw_if_stopped(stop_);
    BinaryNode& node = binary_[index];
    node.bounds = range.bounds;
    node.first = range.first;
    node.count = range.count;
    node.left = 0;
    Range left, right;
    const bool is_small =
        range.count <= most_in_leaf_ && !(range.bounds.area() > kLargeLeaf * binary_[0].bounds.area());
    if (range.count + range.spare > 1 && !is_small && divide(range, depth, left, right)) {
      node.left = next_.fetch_add(2);
      const auto split_left = [&] { return split(node.left, left, depth + 1, task_levels - 1); };
      if (task_levels > 0 && range.count >= kLeastPerTask) {
        // Deferred to `get` where the system refuses a thread.
        auto other = std::async(std::launch::async | std::launch::deferred, split_left);
        const Costs right_costs = split(node.left + 1, right, depth + 1, task_levels - 1);
        return plan(node, other.get(), right_costs);  // throws what the other thread threw
      }
      const Costs left_costs = split_left();
      return plan(node, left_costs, split(node.left + 1, right, depth + 1, 0));
    }
    if (progress_) progress_->done += range.count;
    Costs costs;
    costs.fill(leaf_cost(node));
    node.is_leaf = true;
    node.split.fill(0);
    return costs;
  }

  static float area_of(const BinaryNode& node) {
    // A box without area, all on a line, must cost something too.
    return node.bounds.area() + std::numeric_limits<float>::min();
  }
  static float leaf_cost(const BinaryNode& node) { return area_of(node) * blocks_of(node.count); }

  /// The costs of a node that is split, from its children's.
  Costs plan(BinaryNode& node, const Costs& left, const Costs& right) const {
    Costs costs{};
    for (size_t slots = 2; slots <= kSlots; ++slots) {
      costs[slots] = std::numeric_limits<float>::infinity();
      node.split[slots] = 1;  // if no sum is finite
      for (size_t k = 1; k < slots; ++k) {
        const float cost = left[k] + right[slots - k];
        if (cost < costs[slots]) {
          costs[slots] = cost;
          node.split[slots] = static_cast<uint8_t>(k);
        }
      }
    }
    const float inner_cost = costs[kSlots] + area_of(node) * kNodeCost;
    node.is_leaf = node.count <= most_in_leaf_ && leaf_cost(node) <= inner_cost;
    costs[1] = node.is_leaf ? leaf_cost(node) : inner_cost;
    node.split[1] = 0;
    for (size_t slots = 2; slots < kSlots; ++slots)
      if (costs[slots - 1] <= costs[slots]) {
        costs[slots] = costs[slots - 1];
        node.split[slots] = 0;
      }
    return costs;
  }

  struct Children {
    std::array<uint32_t, kSlots> nodes;
    size_t count = 0;
  };
  void gather(uint32_t index, size_t slots, Children& children) const {
    const BinaryNode& node = binary_[index];
    while (slots > 1 && node.split[slots] == 0) --slots;
    if (slots == 1) {
      children.nodes[children.count++] = index;
      return;
    }
    gather(node.left, node.split[slots], children);
    gather(node.left + 1, slots - node.split[slots], children);
  }

  /// Joins the pieces of a primitive that met again in one leaf.
  static std::span<const PrimitiveReference> without_repeats(std::span<PrimitiveReference> leaf) {
    std::sort(leaf.begin(), leaf.end(), [](const PrimitiveReference& a, const PrimitiveReference& b) {
      return a.primitive < b.primitive;
    });
    size_t kept = 0;
    for (size_t i = 1; i < leaf.size(); ++i) {
      if (leaf[i].primitive != leaf[kept].primitive) {
        leaf[++kept] = leaf[i];
        continue;
      }
      for (size_t axis = 0; axis < 3; ++axis) {
        leaf[kept].lo[axis] = std::min(leaf[kept].lo[axis], leaf[i].lo[axis]);
        leaf[kept].hi[axis] = std::max(leaf[kept].hi[axis], leaf[i].hi[axis]);
      }
    }
    return leaf.first(kept + 1);
  }

  /// The references of a node, between which there may be spare places.
  void collect(const BinaryNode& node, std::vector<PrimitiveReference>& into) const {
    if (node.left == 0) {
      const auto first = references_.begin() + node.first;
      into.insert(into.end(), first, first + node.count);
      return;
    }
    collect(binary_[node.left], into);
    collect(binary_[node.left + 1], into);
  }

  /// Leaves come in the order of their references, which go when many have become leaves.
  ChildRef emit_leaf(const BinaryNode& node) {
    constexpr size_t kMany = size_t{4} << 20;  // bytes
    leaf_.clear();
    collect(node, leaf_);
    const ChildRef leaf = make_leaf_(without_repeats(leaf_));
    const size_t done = size_t{node.first} + node.count;
    if ((done - released_) * sizeof(PrimitiveReference) >= kMany) {
      release_pages(&references_[released_], (done - released_) * sizeof(PrimitiveReference));
      released_ = done;
    }
    return leaf;
  }

  ChildRef emit(uint32_t index) {
    const BinaryNode& node = binary_[index];
    if (node.is_leaf) return emit_leaf(node);
    Children children;
    gather(node.left, node.split[kSlots], children);
    gather(node.left + 1, kSlots - node.split[kSlots], children);
    const auto result = static_cast<uint32_t>(nodes_.size());
    nodes_.push_back(make_empty_node());
    for (size_t slot = 0; slot < children.count; ++slot) {
      const Bounds& b = binary_[children.nodes[slot]].bounds;
      const ChildRef child = emit(children.nodes[slot]);
      set_child(nodes_[result], slot, {Vec3(b.lo[0], b.lo[1], b.lo[2]), Vec3(b.hi[0], b.hi[1], b.hi[2])},
                child);
    }
    return make_child(ChildKind::inner, result);
  }

  LargeVector<PrimitiveReference> references_;
  SpatialSplits spatial_;
  struct Free {
    void operator()(BinaryNode* nodes) const { free_large(nodes); }
  };
  std::unique_ptr<BinaryNode[], Free> binary_;
  std::atomic<uint32_t> next_ = 1;        ///< of binary_
  size_t released_ = 0;                   ///< references
  std::vector<PrimitiveReference> leaf_;  ///< that is being made
  size_t most_in_leaf_;
  const LeafMaker& make_leaf_;
  LargeVector<VolumeNode>& nodes_;
  BuildProgress* progress_;
  std::stop_token stop_;
};

}  // namespace

ChildRef build_sah(LargeVector<PrimitiveReference> references, const PrimitiveSource& source,
                   const BuildOptions& options, const LeafMaker& make_leaf, LargeVector<VolumeNode>& nodes) {
  return SahBuilder(std::move(references), source, options, make_leaf, nodes).build();
}

}  // namespace rayfarm
