#include "common/hierarchy/builder.h"

#include <algorithm>
#include <cmath>

namespace rayfarm {
namespace {

constexpr int kMostSplits = kMostHierarchyLevels - 2;
// Clipping doubles what straddles; beyond this growth it costs more than it saves, and whole primitives go to
// the octant of their centre instead.
constexpr double kMostGrowth = 1.5;

float round_down(double v) {
  const auto f = static_cast<float>(v);
  return static_cast<double>(f) > v ? std::nextafter(f, -std::numeric_limits<float>::infinity()) : f;
}
float round_up(double v) {
  return -round_down(-v);
}

class Builder {
 public:
  Builder(const PrimitiveSource& source, const BuildOptions& options, const LeafMaker& make_leaf,
          std::vector<VolumeNode>& nodes)
      : source_(source), options_(options), make_leaf_(make_leaf), nodes_(nodes) {}

  ChildRef build(std::vector<PrimitiveReference> references, int depth) {
    if (references.empty()) return {};
    if (references.size() <= options_.max_primitives || depth >= kMostSplits) return make_leaf_(references);

    Groups groups;
    if (!(options_.rule == SplitRule::sah ? split_sah(references, groups) : split_thesis(references, groups)))
      return make_leaf_(references);  // all centres coincide
    std::vector<PrimitiveReference>().swap(references);

    const auto index = static_cast<uint32_t>(nodes_.size());
    nodes_.push_back(make_empty_node());
    size_t slot = 0;
    for (std::vector<PrimitiveReference>& group : groups) {
      if (group.empty()) continue;
      const Box box = box_of(group);
      const ChildRef child = build(std::move(group), depth + 1);
      set_child(nodes_[index], slot++, box, child);
    }
    return make_child(ChildKind::inner, index);
  }

 private:
  using Groups = std::array<std::vector<PrimitiveReference>, 8>;

  static Box box_of(std::span<const PrimitiveReference> references) {
    Box box;
    for (const PrimitiveReference& r : references) box.grow(r.box);
    return box;
  }

  /// Splits in two again and again, each time the group that costs most, until there are eight or all are
  /// leaves.
  bool split_sah(std::vector<PrimitiveReference>& references, Groups& groups) const {
    groups[0].swap(references);
    size_t count = 1;
    std::array<double, 8> costs{};  // 0: not to be split
    costs[0] = expected_cost(groups[0]);
    while (count < groups.size()) {
      const auto worst = static_cast<size_t>(std::max_element(costs.begin(), costs.end()) - costs.begin());
      if (costs[worst] == 0) break;
      if (!halve(groups[worst], groups[count])) {
        costs[worst] = 0;
        continue;
      }
      costs[worst] = expected_cost(groups[worst]);
      costs[count] = expected_cost(groups[count]);
      ++count;
    }
    if (count > 1) return true;
    groups[0].swap(references);
    return false;
  }

  double expected_cost(std::span<const PrimitiveReference> group) const {
    if (group.size() <= options_.max_primitives) return 0;
    // A group without area, all on one line, must be split too.
    return (box_of(group).area() + std::numeric_limits<double>::min()) * static_cast<double>(group.size());
  }

  /// Moves what lies on one side of the best of 15 planes on each axis to `other`; false if all centres
  /// coincide.
  bool halve(std::vector<PrimitiveReference>& group, std::vector<PrimitiveReference>& other) const {
    constexpr size_t kBins = 16;
    Box centers;
    for (const PrimitiveReference& r : group) centers.grow(r.box.center());
    const auto bin_of = [&](const PrimitiveReference& r, int axis) {
      const double place = (r.box.center()[axis] - centers.lo[axis]) / (centers.hi[axis] - centers.lo[axis]);
      return std::min(static_cast<size_t>(place * kBins), kBins - 1);
    };
    // Leaves are tested eight lanes at a time, so what counts is how many such tests there are.
    const auto work = [](size_t n) { return static_cast<double>((n + 7) / 8); };
    int best_axis = -1;
    size_t best_bin = 0;
    double best_cost = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      if (!(centers.hi[axis] - centers.lo[axis] > 0)) continue;
      std::array<Box, kBins> boxes;
      std::array<size_t, kBins> counts{};
      for (const PrimitiveReference& r : group) {
        const size_t bin = bin_of(r, axis);
        boxes[bin].grow(r.box);
        ++counts[bin];
      }
      std::array<double, kBins> cost_above{};  // of the bins from i on
      Box box;
      size_t count = 0;
      for (size_t i = kBins; i-- > 1;) {
        box.grow(boxes[i]);
        count += counts[i];
        cost_above[i] = box.area() * work(count);
      }
      box = {};
      count = 0;
      for (size_t i = 1; i < kBins; ++i) {
        box.grow(boxes[i - 1]);
        count += counts[i - 1];
        const double cost = box.area() * work(count) + cost_above[i];
        if (count > 0 && count < group.size() && cost < best_cost) {
          best_cost = cost;
          best_axis = axis;
          best_bin = i;
        }
      }
    }
    if (best_axis < 0) return false;
    const auto middle = std::stable_partition(group.begin(), group.end(), [&](const PrimitiveReference& r) {
      return bin_of(r, best_axis) < best_bin;
    });
    other.assign(middle, group.end());
    group.erase(middle, group.end());
    return true;
  }

  bool split_thesis(const std::vector<PrimitiveReference>& references, Groups& octants) const {
    Vec3 center(0);
    for (const PrimitiveReference& r : references) center += r.box.center();
    center /= static_cast<double>(references.size());
    return split_clipping(references, box_of(references), center, octants) ||
           split_by_centers(references, center, octants);
  }

  bool split_clipping(const std::vector<PrimitiveReference>& references, const Box& data, const Vec3& center,
                      Groups& octants) const {
    const auto most = static_cast<size_t>(kMostGrowth * static_cast<double>(references.size()));
    size_t total = 0, largest = 0;
    for (const PrimitiveReference& r : references) {
      // Which sides of the centre the box lies on, per axis; a box in the plane itself counts as low.
      bool low[3], high[3];
      int sides = 1;
      for (int axis = 0; axis < 3; ++axis) {
        high[axis] = r.box.hi[axis] > center[axis];
        low[axis] = r.box.lo[axis] < center[axis] || !high[axis];
        if (low[axis] && high[axis]) sides *= 2;
      }
      for (size_t octant = 0; octant < 8; ++octant) {
        Box cell = data;
        bool touches = true;
        for (int axis = 0; axis < 3; ++axis) {
          const bool is_high = (octant >> axis & 1) != 0;
          touches = touches && (is_high ? high[axis] : low[axis]);
          (is_high ? cell.lo : cell.hi)[axis] = center[axis];
        }
        if (!touches) continue;
        const Box box = sides == 1 ? r.box : intersection(r.box, source_.clipped(r.primitive, cell));
        if (box.is_empty()) continue;
        octants[octant].push_back({r.primitive, box});
        largest = std::max(largest, octants[octant].size());
        ++total;
      }
      if (total > most) break;
    }
    if (total <= most && largest < references.size()) return true;
    for (auto& octant : octants) octant.clear();
    return false;
  }

  static bool split_by_centers(const std::vector<PrimitiveReference>& references, const Vec3& center,
                               Groups& octants) {
    size_t largest = 0;
    for (const PrimitiveReference& r : references) {
      const Vec3 c = r.box.center();
      const size_t octant =
          (c.x > center.x ? 1u : 0u) | (c.y > center.y ? 2u : 0u) | (c.z > center.z ? 4u : 0u);
      octants[octant].push_back(r);
      largest = std::max(largest, octants[octant].size());
    }
    return largest < references.size();
  }

  const PrimitiveSource& source_;
  const BuildOptions& options_;
  const LeafMaker& make_leaf_;
  std::vector<VolumeNode>& nodes_;
};

}  // namespace

ChildRef build_hierarchy(const PrimitiveSource& source, const BuildOptions& options,
                         const LeafMaker& make_leaf, std::vector<VolumeNode>& nodes) {
  std::vector<PrimitiveReference> references(source.size());
  for (uint32_t i = 0; i < references.size(); ++i) references[i] = {i, source.bounds(i)};
  return Builder(source, options, make_leaf, nodes).build(std::move(references), 0);
}

VolumeNode make_empty_node() {
  VolumeNode node;
  for (auto& axis : node.planes[0]) axis.fill(std::numeric_limits<float>::infinity());
  for (auto& axis : node.planes[1]) axis.fill(-std::numeric_limits<float>::infinity());
  node.children.fill({});
  return node;
}

void set_child(VolumeNode& node, size_t slot, const Box& box, ChildRef child) {
  const double margin = 1e-14 * box.magnitude();
  for (size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<int>(axis);
    node.planes[0][axis][slot] = round_down(box.lo[i] - margin);
    node.planes[1][axis][slot] = round_up(box.hi[i] + margin);
  }
  node.children[slot] = child;
}

Box child_box(const VolumeNode& node, size_t slot) {
  return {Vec3(node.planes[0][0][slot], node.planes[0][1][slot], node.planes[0][2][slot]),
          Vec3(node.planes[1][0][slot], node.planes[1][1][slot], node.planes[1][2][slot])};
}

Box bounds_of(const VolumeNode& node) {
  Box box;
  for (size_t slot = 0; slot < 8; ++slot)
    if (node.children[slot].kind() != ChildKind::empty) box.grow(child_box(node, slot));
  return box;
}

}  // namespace rayfarm
