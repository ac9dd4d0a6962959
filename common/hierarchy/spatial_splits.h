#pragma once
// Spatial splits (Stich, Friedrich, Dietrich 2009): where the boxes of a node's two halves would overlap, a
// plane divides space instead, and what lies on both sides is clipped there and referred to from both. What
// that gains is weighed against the references that it adds, of which there is a budget.
#include <span>
#include <vector>

#include "common/hierarchy/builder.h"
#include "common/hierarchy/lane_bounds.h"

namespace rayfarm {

/// What the SAH calls the cost of `count` primitives: how many blocks of eight are tested.
float blocks_of(size_t count);

class SpatialSplits {
 public:
  /// Looks at all `references` and sees whether splits pay.
  SpatialSplits(const PrimitiveSource& source, BuildQuality quality,
                std::span<const PrimitiveReference> references);

  /// How many references may be added.
  size_t budget() const { return budget_; }

  struct Plane {
    int axis = -1;  ///< none
    float position = 0;
    float cost = std::numeric_limits<float>::infinity();  ///< area × blocks of both sides
  };
  /// The best plane that adds at most `most_added` references.
  Plane best_plane(std::span<const PrimitiveReference> references, const Bounds& bounds,
                   size_t most_added) const;
  /// Whether it is worth looking for a plane where the best division of references makes such children.
  bool is_promising(const Bounds& left, const Bounds& right) const;

  struct Sides {
    size_t left, right;  ///< numbers of references; one is 0 if the plane does not part them
  };
  /// Parts references at a plane: `first[0, left)` and `first[left, left + right)`. What straddles it is
  /// clipped, or stays whole on one side where that costs less. At most `most_added` are added, for which
  /// there must be room.
  Sides divide(PrimitiveReference* first, size_t count, const Plane& plane, size_t most_added) const;

 private:
  bool pays(std::span<const PrimitiveReference> references) const;

  const PrimitiveSource& source_;
  BuildQuality quality_;
  float whole_area_ = 0;
  size_t budget_ = 0;
};

}  // namespace rayfarm
