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

#include "common/hierarchy/cells-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayfarm {
namespace HWY_NAMESPACE {

/// The cells that a ray passes, one after the other.
class CellWalk {
 public:
  /// `entry`: how far the ray goes to be inside.
  HWY_INLINE CellWalk(const Scene& scene, const Grid& grid, const PrimitiveRay& ray, double entry)
      : begins_(scene.grid_cells.subspan(grid.first_cell)),
        pointers_(scene.primitive_pointers),
        grid_(grid),
        ray_(ray) {
    for (size_t i = 0; i < 3; ++i) {
      const auto axis = static_cast<int>(i);
      const double at = (ray.origin[i] + entry * ray.direction[i] - grid.low[axis]) / grid.cell[axis];
      // Where numbers of a damaged scene are too large to be subtracted there is no place: any cell will do.
      place_[i] = at > 0 ? static_cast<uint32_t>(std::min(std::floor(at), grid.cells[i] - 1.0)) : 0;
      set_next(i);
    }
  }
  CellList list() const {
    const size_t cell = grid_.index(place_[0], place_[1], place_[2]);
    return pointers_.subspan(begins_[cell], begins_[cell + 1] - begins_[cell]);
  }
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
    const double ahead = ray_.direction[i] > 0 ? 1 : 0;
    next_[i] = distance_to_plane(ray_, i, grid_.low[axis] + (place_[i] + ahead) * grid_.cell[axis]);
  }

  std::span<const uint32_t> begins_;  ///< of the cells' lists
  std::span<const PrimitivePointer> pointers_;
  const Grid& grid_;
  const PrimitiveRay& ray_;
  std::array<uint32_t, 3> place_;
  std::array<double, 3> next_;  ///< where the ray crosses the faces that lie ahead
};

template <typename Search>
HWY_NOINLINE bool search_grid(const Scene& scene, const Collection& collection, const PrimitiveRay& ray,
                              uint32_t instance, Search& search) {
  const Grid& grid = scene.grids[collection.grid];
  return search_cells(collection, grid.box(), ray, instance, search,
                      [&](double entry) HWY_ATTR { return CellWalk(scene, grid, ray, entry); });
}

}  // namespace HWY_NAMESPACE
}  // namespace rayfarm
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
