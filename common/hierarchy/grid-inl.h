// Rays through grids of equal cells (thesis 2.6.2; Ullner 1983; Cleary and others 1983): the first cell
// follows from where the ray begins or enters, the next from the face that it crosses first. Compiled once
// for each SIMD target.
#if defined(RAYFARM_COMMON_HIERARCHY_GRID_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYFARM_COMMON_HIERARCHY_GRID_INL_H_
#undef RAYFARM_COMMON_HIERARCHY_GRID_INL_H_
#else
#define RAYFARM_COMMON_HIERARCHY_GRID_INL_H_
#endif

#include <hwy/highway.h>

#include <cmath>
#include <limits>

#include "common/hierarchy/cells-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayfarm {
namespace HWY_NAMESPACE {

/// The cells that a ray passes, one after the other.
class CellWalk {
 public:
  /// `entry`: how far the ray goes to be inside.
  HWY_INLINE CellWalk(const Grid& grid, const PrimitiveRay& ray, double entry) : grid_(grid), ray_(ray) {
    for (size_t i = 0; i < 3; ++i) {
      const auto axis = static_cast<int>(i);
      const double at = (ray.origin[i] + entry * ray.direction[i] - grid.low[axis]) / grid.cell[axis];
      // Where numbers of a damaged scene are too large to be subtracted there is no place: any cell will do.
      place_[i] = at > 0 ? static_cast<uint32_t>(std::min(std::floor(at), grid.cells[i] - 1.0)) : 0;
      set_next(i);
    }
  }
  size_t cell() const { return grid_.index(place_[0], place_[1], place_[2]); }
  /// How far the ray is when it leaves the cell.
  double exit() const { return next_[axis_of_exit()]; }
  /// False: the ray leaves the grid.
  HWY_INLINE bool advance() {
    const size_t axis = axis_of_exit();
    if (ray_.direction[axis] > 0 ? ++place_[axis] == grid_.cells[axis] : place_[axis]-- == 0) return false;
    set_next(axis);
    return true;
  }

 private:
  size_t axis_of_exit() const {
    const size_t xy = next_[1] < next_[0] ? 1 : 0;
    return next_[2] < next_[xy] ? 2 : xy;
  }
  /// From the cell's place, not from the face before: so errors do not add up.
  HWY_INLINE void set_next(size_t i) {
    const auto axis = static_cast<int>(i);
    const double direction = ray_.direction[i];
    const double face = grid_.low[axis] + (place_[i] + (direction > 0 ? 1.0 : 0.0)) * grid_.cell[axis];
    next_[i] = direction == 0 ? std::numeric_limits<double>::infinity() : (face - ray_.origin[i]) / direction;
  }

  const Grid& grid_;
  const PrimitiveRay& ray_;
  std::array<uint32_t, 3> place_;
  std::array<double, 3> next_;  ///< where the ray crosses the faces that lie ahead
};

/// True: the search is over. What a cell lists may be hit in another cell: the walk goes on until the next
/// lies behind the hit.
template <typename Search>
HWY_NOINLINE bool search_grid(const Scene& scene, const Collection& collection, const PrimitiveRay& ray,
                              uint32_t instance, Search& search) {
  const Grid& grid = scene.grids[collection.grid];
  if (is_too_far_for_cells(grid.box(), ray.origin_vector()))
    return search_list(collection, ray, instance, search);
  const Passage passage = passage_through(with_margin(grid.box()), ray);
  if (passage.is_empty() || passage.begin > search.t_far()) return false;
  const auto ends = scene.grid_cells.subspan(grid.first_cell);
  CellTests tests(scene, collection, ray, instance, search);
  CellWalk walk(grid, ray, passage.begin);
  do {
    const size_t cell = walk.cell();
    if (tests.test(ends[cell], ends[cell + 1] - ends[cell])) return true;
  } while (walk.exit() <= search.t_far() && walk.advance());
  return false;
}

}  // namespace HWY_NAMESPACE
}  // namespace rayfarm
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
