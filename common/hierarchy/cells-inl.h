// What rays do in cells, of grids and octrees alike, and in other lists of primitives. Compiled once for each
// SIMD target.
#if defined(RAYFARM_COMMON_HIERARCHY_CELLS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYFARM_COMMON_HIERARCHY_CELLS_INL_H_
#undef RAYFARM_COMMON_HIERARCHY_CELLS_INL_H_
#else
#define RAYFARM_COMMON_HIERARCHY_CELLS_INL_H_
#endif

#include <hwy/highway.h>

#include <limits>

#include "common/hierarchy/cells.h"
#include "common/hierarchy/leaf_tests-inl.h"
#include "common/hierarchy/mailbox.h"

HWY_BEFORE_NAMESPACE();
namespace rayfarm {
namespace HWY_NAMESPACE {

/// The distances between which a ray is inside a box.
struct Passage {
  double begin, end;
  bool is_empty() const { return !(begin <= end); }
};

HWY_INLINE Passage passage_through(const Box& box, const PrimitiveRay& ray) {
  Passage passage{0, std::numeric_limits<double>::infinity()};
  for (size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<int>(i);
    if (ray.direction[i] == 0) {
      if (!(ray.origin[i] >= box.lo[axis] && ray.origin[i] <= box.hi[axis])) return {1, 0};
      continue;
    }
    const double a = (box.lo[axis] - ray.origin[i]) / ray.direction[i],
                 b = (box.hi[axis] - ray.origin[i]) / ray.direction[i];
    passage.begin = std::max(passage.begin, std::min(a, b));
    passage.end = std::min(passage.end, std::max(a, b));
  }
  return passage;
}

/// How far along the ray a plane across an axis is; infinite if they are parallel.
HWY_INLINE double distance_to_plane(const PrimitiveRay& ray, size_t axis, double plane) {
  return ray.direction[axis] == 0 ? std::numeric_limits<double>::infinity()
                                  : (plane - ray.origin[axis]) / ray.direction[axis];
}

using CellList = std::span<const PrimitivePointer>;

/// Tests the lists on a ray's way, with a mailbox each primitive once (Shirley, Sung and
/// Brown, 2.3).
template <typename Search>
class CellTests {
 public:
  HWY_INLINE CellTests(const Collection& collection, const PrimitiveRay& ray, uint32_t instance,
                       Search& search)
      : ray_(ray),
        instance_(instance),
        search_(search),
        mailbox_(collection.has_mailbox != 0 ? &Mailbox::of_this_thread() : nullptr) {
    if (mailbox_) mailbox_search_ = mailbox_->begin_search(collection);
  }
  /// The primitives of a list. True: the search is over.
  HWY_INLINE bool test(const CellList& list) {
    for (const PrimitivePointer& pointer : list) {
      if (mailbox_ && !mailbox_->take(pointer, mailbox_search_)) {
        if constexpr (Search::kCounts) search_.count_saved_test();
        continue;
      }
      if (search_.test(pointer, ray_, instance_)) return true;
    }
    return false;
  }

 private:
  const PrimitiveRay& ray_;
  uint32_t instance_;
  Search& search_;
  Mailbox* mailbox_;  ///< none: tests are made again
  Mailbox::Search mailbox_search_{};
};

/// Searches cells that fill `box`; true: the search is over. `begin_walk(entry)` makes a walk from cell to
/// cell, from where the ray has gone as far as `entry`. What a cell lists may be hit in another: the walk
/// goes on until the next cell lies behind the hit.
template <typename Search, typename BeginWalk>
HWY_INLINE bool search_cells(const Collection& collection, const Box& box, const PrimitiveRay& ray,
                             uint32_t instance, Search& search, BeginWalk begin_walk) {
  if (is_too_far(box.magnitude(), ray.origin_vector())) return search_list(collection, ray, instance, search);
  const Passage passage = passage_through(with_margin(box), ray);
  if (passage.is_empty() || passage.begin > search.t_far()) return false;
  CellTests tests(collection, ray, instance, search);
  auto walk = begin_walk(passage.begin);
  do {
    const CellList list = walk.list();
    if constexpr (Search::kCounts) search.count_cell(static_cast<uint32_t>(list.size()));
    if (tests.test(list)) return true;
  } while (walk.exit() <= search.t_far() && walk.advance());
  return false;
}

}  // namespace HWY_NAMESPACE
}  // namespace rayfarm
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
