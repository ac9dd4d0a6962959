#include <algorithm>

#include "common/hierarchy/builder.h"

namespace rayfarm {
namespace {

constexpr int kMostSplits = kMostHierarchyLevels - 2;
// Clipping doubles what straddles; beyond this growth it costs more than it saves, and whole primitives go to
// the octant of their centre instead.
constexpr double kMostGrowth = 1.5;

Box box_of(std::span<const PrimitiveReference> references) {
  Box box;
  for (const PrimitiveReference& r : references) box.grow(r.box());
  return box;
}

class ThesisBuilder {
 public:
  ThesisBuilder(const PrimitiveSource& source, const BuildOptions& options, const LeafMaker& make_leaf,
                LargeVector<VolumeNode>& nodes)
      : source_(source), options_(options), make_leaf_(make_leaf), nodes_(nodes) {}

  ChildRef build(LargeVector<PrimitiveReference> references, int depth) {
    throw_if_stopped(options_.stop);
    Octants octants;
    // Where all centres coincide there is no split.
    if (references.size() <= options_.max_primitives || depth >= kMostSplits || !split(references, octants)) {
      if (options_.progress) options_.progress->done += references.size();
      return make_leaf_(references);
    }
    LargeVector<PrimitiveReference>().swap(references);

    const auto index = static_cast<uint32_t>(nodes_.size());
    nodes_.push_back(make_empty_node());
    size_t slot = 0;
    for (LargeVector<PrimitiveReference>& octant : octants) {
      if (octant.empty()) continue;
      const Box box = box_of(octant);
      const ChildRef child = build(std::move(octant), depth + 1);
      set_child(nodes_[index], slot++, box, child);
    }
    return make_child(ChildKind::inner, index);
  }

 private:
  using Octants = std::array<LargeVector<PrimitiveReference>, 8>;

  bool split(const LargeVector<PrimitiveReference>& references, Octants& octants) const {
    Vec3 center(0);
    for (const PrimitiveReference& r : references) center += r.box().center();
    center /= static_cast<double>(references.size());
    return split_clipping(references, box_of(references), center, octants) ||
           split_by_centers(references, center, octants);
  }

  bool split_clipping(const LargeVector<PrimitiveReference>& references, const Box& data, const Vec3& center,
                      Octants& octants) const {
    const auto most = static_cast<size_t>(kMostGrowth * static_cast<double>(references.size()));
    size_t total = 0, largest = 0;
    for (const PrimitiveReference& r : references) {
      const Box whole = r.box();
      // Which sides of the centre the box lies on, per axis; a box in the plane itself counts as low.
      bool low[3], high[3];
      int sides = 1;
      for (int axis = 0; axis < 3; ++axis) {
        high[axis] = whole.hi[axis] > center[axis];
        low[axis] = whole.lo[axis] < center[axis] || !high[axis];
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
        const Box box = sides == 1 ? whole : intersection(whole, source_.clipped(r.primitive, cell));
        if (box.is_empty()) continue;
        octants[octant].push_back(make_reference(r.primitive, box));
        largest = std::max(largest, octants[octant].size());
        ++total;
      }
      if (total > most) break;
    }
    if (total <= most && largest < references.size()) return true;
    for (auto& octant : octants) octant.clear();
    return false;
  }

  static bool split_by_centers(const LargeVector<PrimitiveReference>& references, const Vec3& center,
                               Octants& octants) {
    size_t largest = 0;
    for (const PrimitiveReference& r : references) {
      const Vec3 c = r.box().center();
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
  LargeVector<VolumeNode>& nodes_;
};

}  // namespace

ChildRef build_thesis(LargeVector<PrimitiveReference> references, const PrimitiveSource& source,
                      const BuildOptions& options, const LeafMaker& make_leaf,
                      LargeVector<VolumeNode>& nodes) {
  return ThesisBuilder(source, options, make_leaf, nodes).build(std::move(references), 0);
}

}  // namespace rayfarm
