#include "common/hierarchy/grid.h"

#include "common/hierarchy/cells.h"

namespace rayfarm {
namespace {

/// The cells from `first` to `last` along each axis.
struct CellRange {
  std::array<uint32_t, 3> first, last;
  uint32_t length(size_t axis) const { return last[axis] - first[axis] + 1; }
  uint64_t count() const { return uint64_t{length(0)} * length(1) * length(2); }
};

/// Finds the cells that a primitive has a part in: its box's cells are halved, and what it has no part in is
/// left out.
class CellFinder {
 public:
  CellFinder(const Grid& grid, const PrimitiveSource& source, const BuildOptions& options)
      : grid_(grid),
        source_(source),
        options_(options),
        margin_(with_margin(grid.box()).hi - grid.box().hi) {}

  /// Calls visit(cell), in no order.
  template <typename Visit>
  void for_each_cell(uint32_t primitive, Visit visit) const {
    const Box box = source_.bounds(primitive);
    CellRange range;
    for (size_t i = 0; i < 3; ++i) {
      const auto axis = static_cast<int>(i);
      const auto index = [&](double x) {
        return static_cast<uint32_t>(
            std::clamp(std::floor((x - grid_.low[axis]) / grid_.cell[axis]), 0.0, grid_.cells[i] - 1.0));
      };
      range.first[i] = index(box.lo[axis] - margin_[axis]);
      range.last[i] = index(box.hi[axis] + margin_[axis]);
    }
    if (range.count() == 1)
      visit(grid_.index(range.first[0], range.first[1], range.first[2]));
    else
      search(primitive, range, visit);
  }

 private:
  template <typename Visit>
  void search(uint32_t primitive, const CellRange& range, Visit& visit) const {
    constexpr uint64_t kFewCells = 8, kManyCells = 4096;
    const uint64_t count = range.count();
    if (count > kManyCells) throw_if_stopped(options_.stop);
    if ((count == 1 || count > kFewCells) && source_.clipped(primitive, box_of(range)).is_empty()) return;
    if (count == 1) return visit(grid_.index(range.first[0], range.first[1], range.first[2]));
    const size_t axis = range.length(0) >= range.length(1) ? (range.length(0) >= range.length(2) ? 0 : 2)
                                                           : (range.length(1) >= range.length(2) ? 1 : 2);
    CellRange low = range, high = range;
    low.last[axis] = range.first[axis] + range.length(axis) / 2 - 1;
    high.first[axis] = low.last[axis] + 1;
    search(primitive, low, visit);
    search(primitive, high, visit);
  }

  Box box_of(const CellRange& r) const {
    const Vec3 low = grid_.low + grid_.cell * Vec3(r.first[0], r.first[1], r.first[2]),
               high = grid_.low + grid_.cell * Vec3(r.last[0] + 1, r.last[1] + 1, r.last[2] + 1);
    return {low - margin_, high + margin_};
  }

  const Grid& grid_;
  const PrimitiveSource& source_;
  const BuildOptions& options_;
  Vec3 margin_;
};

uint32_t cells_along_an_axis(size_t primitives, uint32_t asked_for) {
  constexpr double kCellsPerPrimitive = 4;
  if (asked_for > 0) return asked_for;
  const double cells = std::cbrt(kCellsPerPrimitive * static_cast<double>(primitives));
  return static_cast<uint32_t>(std::clamp(std::round(cells), 1.0, double{kMostCells}));
}

}  // namespace

uint32_t build_grid(const PrimitiveSource& source, std::span<const PrimitivePointer> pointers,
                    const BuildOptions& options, SceneArrays<GrowingArray>& arrays) {
  const Box box = thick_bounds(source);
  Grid grid;
  grid.cells.fill(cells_along_an_axis(source.size(), options.cells));
  grid.low = box.lo;
  grid.cell = box.extent() / Vec3(grid.cells[0], grid.cells[1], grid.cells[2]);
  check_count(arrays.grid_cells.size() + grid.cell_count() + 1, "cells", "--cells");
  grid.first_cell = static_cast<uint32_t>(arrays.grid_cells.size());

  const CellFinder finder(grid, source, options);
  if (options.progress) options.progress->total += 2 * source.size();  // each is looked at twice
  const auto begin_primitive = [&] {
    throw_if_stopped(options.stop);
    if (options.progress) ++options.progress->done;
  };
  std::vector<uint32_t> ends(grid.cell_count() + 1);  // first how long each list is
  uint64_t count = arrays.primitive_pointers.size();
  for (uint32_t i = 0; i < source.size(); ++i) {
    begin_primitive();
    finder.for_each_cell(i, [&](size_t cell) {
      ++ends[cell];
      ++count;
    });
    check_count(count, "pointers from cells to primitives", "--cells");
  }
  auto end = static_cast<uint32_t>(arrays.primitive_pointers.size());
  for (uint32_t& e : ends) e = end += e;
  arrays.primitive_pointers.resize(end);
  for (auto i = static_cast<uint32_t>(source.size()); i-- > 0;) {  // from behind: the lists are in order
    begin_primitive();
    finder.for_each_cell(i, [&](size_t cell) { arrays.primitive_pointers[--ends[cell]] = pointers[i]; });
  }
  arrays.grid_cells.insert(arrays.grid_cells.end(), ends.begin(), ends.end());
  arrays.grids.push_back(grid);
  return static_cast<uint32_t>(arrays.grids.size() - 1);
}

}  // namespace rayfarm
