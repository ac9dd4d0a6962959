#include <algorithm>

#include "common/hierarchy/octants.h"

namespace rayfarm {
namespace {

class ThesisBuilder {
 public:
  ThesisBuilder(const PrimitiveSource& source, const BuildOptions& options, const Box& whole,
                const LeafMaker& make_leaf, LargeVector<VolumeNode>& nodes)
      : divider_(source, options, whole, 0), options_(options), make_leaf_(make_leaf), nodes_(nodes) {}

  ChildRef build(VolumeData volume) {
    throw_if_stopped(options_.stop);
    Octants octants;
    if (!divider_.is_to_be_divided(volume) || !divide(volume, octants)) {
      if (options_.progress) options_.progress->done += volume.references.size();
      return make_leaf_(volume.references);
    }
    LargeVector<PrimitiveReference>().swap(volume.references);

    const auto index = static_cast<uint32_t>(nodes_.size());
    nodes_.push_back(make_empty_node());
    size_t slot = 0;
    for (VolumeData& octant : octants) {
      if (octant.references.empty()) continue;
      const Box box = octant.box();
      const ChildRef child = build(std::move(octant));
      set_child(nodes_[index], slot++, box, child);
    }
    return make_child(ChildKind::inner, index);
  }

 private:
  bool divide(const VolumeData& volume, Octants& octants) const {
    const Vec3 center = divider_.center_of(volume);
    if (divider_.clip(volume, center, octants)) return true;
    return options_.thesis.clip == ThesisClip::bounded && split_by_centers(volume, center, octants);
  }

  /// False where all centres are in one octant.
  static bool split_by_centers(const VolumeData& volume, const Vec3& center, Octants& octants) {
    for (VolumeData& octant : octants) {
      octant.depth = volume.depth + 1;
      octant.growth = volume.growth;
    }
    size_t largest = 0;
    for (const PrimitiveReference& r : volume.references) {
      const Vec3 c = r.box().center();
      VolumeData& octant =
          octants[(c.x > center.x ? 1u : 0u) | (c.y > center.y ? 2u : 0u) | (c.z > center.z ? 4u : 0u)];
      octant.references.push_back(r);
      largest = std::max(largest, octant.references.size());
    }
    return largest < volume.references.size();
  }

  OctantDivider divider_;
  const BuildOptions& options_;
  const LeafMaker& make_leaf_;
  LargeVector<VolumeNode>& nodes_;
};

}  // namespace

ChildRef build_thesis(LargeVector<PrimitiveReference> references, const PrimitiveSource& source,
                      const BuildOptions& options, const LeafMaker& make_leaf,
                      LargeVector<VolumeNode>& nodes) {
  VolumeData all{std::move(references)};
  return ThesisBuilder(source, options, all.box(), make_leaf, nodes).build(std::move(all));
}

}  // namespace rayfarm
