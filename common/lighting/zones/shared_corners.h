#pragma once
// Corners of cells as surfaces go on over them: corners at one place, of one material and normal, are one,
// whichever primitives they are of. A value at a corner is the mean of the cells that share it, by area.
#include <optional>

#include "common/lighting/zones/zone_map.h"

namespace rayfarm {

class SharedCorners {
 public:
  /// Of grids that `is_of` takes, and their cells that have an area. `map` must outlive it.
  template <typename IsOf>
  SharedCorners(const ZoneMap& map, IsOf is_of) : map_(map) {
    for (const ZoneGrid& grid : map.grids()) is_of_.push_back(grid.shape != ZoneShape::none && is_of(grid));
    find();
  }

  /// `value(grid, cell, side)`: of each cell that has an area.
  template <typename Value>
  void set(Value value) {
    std::vector<std::array<Color, 2>> sums(areas_.size(), {Color(0), Color(0)});
    for_each_corner([&](const ZoneGrid& grid, uint32_t cell, double area, uint32_t corner) {
      for (uint32_t side = 0; side < 2; ++side)
        sums[shared_[corner]][side] += area * Color(value(grid, cell, side));
    });
    values_.clear();
    for (size_t i = 0; i < sums.size(); ++i)
      for (const Color& sum : sums[i]) values_.push_back(sum / areas_[i]);
  }

  /// Linear between the corners about a place; nothing where only cells without an area are about it.
  std::optional<Color> at(const ZoneGrid& grid, const GridPlace& place, uint32_t side) const {
    const CellCorners corners = map_.corners_at(grid, place);
    Color sum(0);
    double weight = 0;
    for (size_t i = 0; i < 4; ++i) {
      const uint32_t shared = shared_[grid.first_corner + corners.corner[i]];
      if (shared == kNone || !(corners.weight[i] > 0)) continue;
      sum += corners.weight[i] * Color(values_[2 * size_t{shared} + side]);
      weight += corners.weight[i];
    }
    if (!(weight > 0)) return std::nullopt;
    return sum / weight;
  }

 private:
  void find();
  /// Calls visit(grid, cell, area, corner) for the corners of all cells.
  template <typename Visit>
  void for_each_corner(Visit visit) const {
    const std::span<const ZoneGrid> grids = map_.grids();
    for (size_t i = 0; i < grids.size(); ++i) {
      if (!is_of_[i]) continue;
      for (uint32_t cell = 0; cell < grids[i].cell_count; ++cell)
        if (const double area = map_.area(grids[i], cell); area > 0)
          for (const uint32_t corner : map_.corners_of(grids[i], cell))
            visit(grids[i], cell, area, grids[i].first_corner + corner);
    }
  }

  const ZoneMap& map_;
  std::vector<char> is_of_;         ///< by grid
  GrowingArray<uint32_t> shared_;   ///< by corner: its number; kNone: only cells without an area are about it
  std::vector<double> areas_;       ///< by number: of the cells about it
  GrowingArray<glm::vec3> values_;  ///< by number and side
};

}  // namespace rayfarm
