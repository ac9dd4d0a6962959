#include "common/hierarchy/octants.h"

#include <algorithm>

namespace rayfarm {
namespace {

/// Clipping doubles what straddles; beyond this growth, in one division, it costs more than it saves.
constexpr double kBoundedGrowth = 1.5;

}  // namespace

Box VolumeData::box() const {
  Box box;
  for (const PrimitiveReference& r : references) box.grow(r.box());
  return box;
}

OctantDivider::OctantDivider(const PrimitiveSource& source, const BuildOptions& options, const Box& whole,
                             double margin)
    : source_(source),
      options_(options),
      margin_(margin),
      least_extent_(kLeastVolume * max_component(whole.extent())) {}

Vec3 OctantDivider::center_of(const VolumeData& volume) const {
  if (options_.thesis.center == ThesisCenter::volume) return volume.box().center();
  Vec3 center(0);
  for (const PrimitiveReference& r : volume.references) center += r.box().center();
  return center / static_cast<double>(volume.references.size());
}

bool OctantDivider::is_to_be_divided(const VolumeData& volume) const {
  return volume.references.size() > options_.max_primitives && volume.depth < kMostDepth &&
         !(clips_always() && max_component(volume.box().extent()) <= least_extent_);
}

bool OctantDivider::clip(const VolumeData& volume, const Vec3& center, Octants& octants) const {
  const auto size = static_cast<double>(volume.references.size());
  const auto most =
      static_cast<size_t>(clips_always() ? kMostGrowth / volume.growth * size : kBoundedGrowth * size);
  const Box data = volume.box();
  size_t total = 0, largest = 0;
  for (const PrimitiveReference& r : volume.references) {
    const Box whole = r.box();
    // Which sides of the centre the box lies on, per axis; a box in the plane itself counts as low.
    bool low[3], high[3];
    int sides = 1;
    for (int axis = 0; axis < 3; ++axis) {
      high[axis] = whole.hi[axis] > center[axis] - margin_;
      low[axis] = whole.lo[axis] < center[axis] + margin_ || !high[axis];
      if (low[axis] && high[axis]) sides *= 2;
    }
    for (size_t octant = 0; octant < 8; ++octant) {
      Box cell{data.lo - Vec3(margin_), data.hi + Vec3(margin_)};
      bool touches = true;
      for (int axis = 0; axis < 3; ++axis) {
        const bool is_high = (octant >> axis & 1) != 0;
        touches = touches && (is_high ? high[axis] : low[axis]);
        (is_high ? cell.lo : cell.hi)[axis] = center[axis] + (is_high ? -margin_ : margin_);
      }
      if (!touches) continue;
      const Box box = sides == 1 ? whole : intersection(whole, source_.clipped(r.primitive, cell));
      if (box.is_empty()) continue;
      octants[octant].references.push_back(make_reference(r.primitive, box));
      largest = std::max(largest, octants[octant].references.size());
      ++total;
    }
    if (total > most) break;
  }
  if (total > most || (!clips_always() && largest >= volume.references.size())) {
    for (VolumeData& octant : octants) octant.references.clear();
    return false;
  }
  if (options_.progress) options_.progress->total += total - volume.references.size();
  for (VolumeData& octant : octants) {
    octant.depth = volume.depth + 1;
    octant.growth = volume.growth * static_cast<double>(total) / size;
  }
  return true;
}

}  // namespace rayfarm
