#pragma once
// The volume hierarchy's builder (thesis 4.2.1.2): a node's data are divided among up to eight children, and
// each child is fitted again to the data that fell into it. The result is a tree of eight tight boxes per
// node. A builder never knows its primitives: it takes bounds, clips them, and gives ranges of references to
// a structurer.
#include <algorithm>
#include <cmath>
#include <functional>
#include <span>

#include "common/hierarchy/lane_bounds.h"
#include "common/memory/large_vector.h"
#include "common/scene/build_options.h"
#include "common/scene/hierarchy_records.h"

namespace rayfarm {

/// Slabs of equal width across an axis, one behind the other.
struct Slabs {
  size_t axis;
  float origin, width;
  size_t count;
  float per_width = 1 / width;

  float plane(size_t i) const { return origin + static_cast<float>(i) * width; }  ///< where slab i begins
  size_t index(float x) const {
    const float i = (x - origin) * per_width;
    return i > 0 ? static_cast<size_t>(std::min(i, static_cast<float>(count - 1))) : 0;
  }
  /// False if rounding makes planes coincide.
  bool are_distinct() const {
    return width > 0 && plane(1) > origin && plane(count) > plane(count - 1) && std::isfinite(plane(count));
  }
};

/// What the builder asks about the primitives of one part.
class PrimitiveSource {
 public:
  virtual ~PrimitiveSource() = default;
  virtual size_t size() const = 0;
  virtual Box bounds(uint32_t primitive) const = 0;
  /// The box of the primitive's piece inside `cell`, empty if there is none. May be larger, never smaller.
  virtual Box clipped(uint32_t primitive, const Box& cell) const = 0;
  /// Grows `pieces[i]`, for each of the slabs first to last, by about the primitive's piece in it: a measure
  /// for choices, where `clipped` is exact.
  virtual void chop(uint32_t primitive, const Slabs& slabs, size_t first, size_t last, Bounds* pieces) const;
};

/// A primitive, or a clipped piece of one, with its bounds rounded outward. 32 bytes.
struct PrimitiveReference {
  std::array<float, 3> lo;
  uint32_t primitive;
  std::array<float, 3> hi;
  uint32_t padding;

  Box box() const { return {Vec3(lo[0], lo[1], lo[2]), Vec3(hi[0], hi[1], hi[2])}; }
};
PrimitiveReference make_reference(uint32_t primitive, const Box& box);

/// The structurer: packs a leaf's references into records for the traverser. It may append nodes.
using LeafMaker = std::function<ChildRef(std::span<const PrimitiveReference>)>;

/// References to all whole primitives, made on all cores.
LargeVector<PrimitiveReference> make_references(const PrimitiveSource& source, const BuildOptions& options);

/// Appends the nodes of a hierarchy of volumes to `nodes`, parents before children, and returns its root
/// (empty without primitives). The depth is below kMostHierarchyLevels. Uses every core of the machine, as
/// far as it grants threads; the result does not depend on how many there are. Throws Stopped, and what
/// `source` and `make_leaf` throw.
ChildRef build_hierarchy(const PrimitiveSource& source, const BuildOptions& options,
                         const LeafMaker& make_leaf, LargeVector<VolumeNode>& nodes);

/// The two rules for volumes (sah_builder.cpp, thesis_builder.cpp). `references` is not empty.
ChildRef build_sah(LargeVector<PrimitiveReference> references, const PrimitiveSource& source,
                   const BuildOptions& options, const LeafMaker& make_leaf, LargeVector<VolumeNode>& nodes);
ChildRef build_thesis(LargeVector<PrimitiveReference> references, const PrimitiveSource& source,
                      const BuildOptions& options, const LeafMaker& make_leaf,
                      LargeVector<VolumeNode>& nodes);

}  // namespace rayfarm
