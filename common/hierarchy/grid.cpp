#include "common/hierarchy/grid.h"

#include "common/hierarchy/cells.h"

namespace rayfarm {
namespace {

/// Calls visit(cell) for those that the primitive has a part in.
template <typename Visit>
void for_each_cell(const Grid& grid, const PrimitiveSource& source, uint32_t primitive, Visit visit) {
  const Box whole = grid.box(), box = source.bounds(primitive);
  const Vec3 margin = with_margin(whole).hi - whole.hi;
  std::array<uint32_t, 3> first, last;
  for (size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<int>(i);
    const auto index = [&](double x) {
      return static_cast<uint32_t>(
          std::clamp(std::floor((x - grid.low[axis]) / grid.cell[axis]), 0.0, grid.cells[i] - 1.0));
    };
    first[i] = index(box.lo[axis] - margin[axis]);
    last[i] = index(box.hi[axis] + margin[axis]);
  }
  for (uint32_t z = first[2]; z <= last[2]; ++z)
    for (uint32_t y = first[1]; y <= last[1]; ++y)
      for (uint32_t x = first[0]; x <= last[0]; ++x) {
        const Vec3 low = grid.low + grid.cell * Vec3(x, y, z);
        const Box cell{low - margin, low + grid.cell + margin};
        if (first == last || !source.clipped(primitive, cell).is_empty()) visit(grid.index(x, y, z));
      }
}

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

  std::vector<uint32_t> ends(grid.cell_count() + 1);  // first how long each list is
  for (uint32_t i = 0; i < source.size(); ++i) {
    throw_if_stopped(options.stop);
    for_each_cell(grid, source, i, [&](size_t cell) { ++ends[cell]; });
  }
  uint64_t end = arrays.primitive_pointers.size();
  for (uint32_t& e : ends) {
    end += e;
    check_count(end, "pointers from cells to primitives", "--cells");
    e = static_cast<uint32_t>(end);
  }
  arrays.primitive_pointers.resize(end);
  for (auto i = static_cast<uint32_t>(source.size()); i-- > 0;) {  // from behind: the lists are in order
    throw_if_stopped(options.stop);
    for_each_cell(grid, source, i,
                  [&](size_t cell) { arrays.primitive_pointers[--ends[cell]] = pointers[i]; });
  }
  arrays.grid_cells.insert(arrays.grid_cells.end(), ends.begin(), ends.end());
  arrays.grids.push_back(grid);
  return static_cast<uint32_t>(arrays.grids.size() - 1);
}

}  // namespace rayfarm
