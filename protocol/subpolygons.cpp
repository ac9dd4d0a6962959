#include "protocol/subpolygons.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rayfarm {
namespace {

constexpr int kPerProcessor = 64;
constexpr int kLeastSide = 8;

int boundary(int extent, int parts, int i) {
  return static_cast<int>(int64_t{extent} * i / parts);
}

/// The cell of an even division that holds `position`, or -1 if no cell begins there.
int cell_at(int extent, int parts, int position) {
  if (position < 0 || position >= extent) return -1;
  const auto guess = static_cast<int>((int64_t{position} * parts + parts - 1) / extent);
  for (int i = std::max(0, guess - 1); i <= std::min(parts - 1, guess + 1); ++i)
    if (boundary(extent, parts, i) == position) return i;
  return -1;
}

}  // namespace

DisplayPolygon SubpolygonGrid::polygon(int subpolygon) const {
  const int column = subpolygon % columns, row = subpolygon / columns;
  return {static_cast<uint16_t>(left + boundary(width, columns, column)),
          static_cast<uint16_t>(top + boundary(height, rows, row)),
          static_cast<uint16_t>(left + boundary(width, columns, column + 1) - 1),
          static_cast<uint16_t>(top + boundary(height, rows, row + 1) - 1)};
}

int SubpolygonGrid::find(const DisplayPolygon& p) const {
  const int column = cell_at(width, columns, p.left - left), row = cell_at(height, rows, p.top - top);
  if (column < 0 || row < 0) return -1;
  const int subpolygon = row * columns + column;
  return polygon(subpolygon) == p ? subpolygon : -1;
}

SubpolygonGrid make_grid(int left, int top, int width, int height, int processors) {
  const double area = double(width) * height / (double(kPerProcessor) * std::max(1, processors));
  const int side = std::max(kLeastSide, static_cast<int>(std::sqrt(area)));
  return {left, top, width, height, std::max(1, width / side), std::max(1, height / side)};
}

int interleaved_owner(const SubpolygonGrid& grid, int processors, int frame_index, int subpolygon) {
  // Counting row by row, rows repeat after processors / gcd of them; shifting by one there keeps columns from
  // belonging to one processor and leaves the counts even.
  const int period = processors / std::gcd(grid.columns, processors);
  const int shift = (subpolygon / grid.columns) / period;
  return static_cast<int>((int64_t{subpolygon} + shift + frame_index) % processors);
}

std::vector<int> interleaved_set(const SubpolygonGrid& grid, int processors, int frame_index, int processor) {
  std::vector<int> set;
  for (int s = 0; s < grid.count(); ++s)
    if (interleaved_owner(grid, processors, frame_index, s) == processor) set.push_back(s);
  return set;
}

}  // namespace rayfarm
