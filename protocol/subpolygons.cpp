#include "protocol/subpolygons.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace rayfarm {
namespace {

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

int golden_part(int n) {
  return static_cast<int>(0.6180339887498949 * n + 0.5);
}

/// The number nearest to n's golden part whose multiples reach all of n.
int golden_step(int n) {
  const int middle = golden_part(n);
  for (int off = 0;; ++off)
    for (const int step : {middle - off, middle + off})
      if (step > 0 && std::gcd(step, n) == 1) return step;
}

/// About `wanted` subpolygons in all.
SubpolygonGrid best_grid(int left, int top, int width, int height, int processors, double wanted,
                         int least_side) {
  const int most_columns = std::max(1, width / least_side), most_rows = std::max(1, height / least_side);
  const double squares = std::sqrt(wanted * width / height);  // columns that make subpolygons square
  SubpolygonGrid best{left, top, width, height, 1, 1};
  double least_fault = std::numeric_limits<double>::infinity();
  const auto whole = [](double x, int most) { return static_cast<int>(std::clamp(x, 1.0, double(most))); };
  for (int columns = whole(0.7 * squares, most_columns); columns <= whole(1.4 * squares + 1, most_columns);
       ++columns)
    for (int rows = whole(0.9 * wanted / columns, most_rows);
         rows <= whole(1.1 * wanted / columns + 1, most_rows); ++rows) {
      const double count = double(columns) * rows, each = count / processors;
      const double aspect = double(width) * rows / (double(height) * columns);
      const double largest = std::ceil(double(width) / columns) * std::ceil(double(height) / rows) * count /
                             (double(width) * height);  // of a subpolygon, to the mean
      // What matters most is that all processors have as much to do: as many subpolygons, of one size.
      const double fault = (std::ceil(each) / each - 1) + 0.5 * (largest - 1) +
                           0.25 * std::abs(std::log(count / wanted)) + 0.1 * std::abs(std::log(aspect));
      if (fault < least_fault) {
        least_fault = fault;
        best.columns = columns;
        best.rows = rows;
      }
    }
  return best;
}

/// Counting row by row gives every processor as many; so do the rows in any other order, as long as whole
/// periods, after which their beginnings repeat, stay together. In this one each row begins about a golden
/// part of the processors further on than the one above.
int lattice_owner(const SubpolygonGrid& grid, int processors, SubpolygonId subpolygon) {
  const int64_t row = subpolygon.value() / grid.columns, column = subpolygon.value() % grid.columns;
  const int common = std::gcd(grid.columns, processors), period = processors / common;
  const bool is_whole_period = row / period < grid.rows / period;
  const int64_t step = is_whole_period ? golden_step(period) : grid.columns / common % period;
  const int64_t begin = common * (row % period * step % period);
  const int64_t shift = row / period * std::max(1, golden_part(common));
  return static_cast<int>((column + begin + shift) % processors);
}

// Subpolygons larger than this have little header, and what compresses them has learnt.
constexpr int kLargeEnough_px = 24 * 24;
// Of subpolygons of each processor. With 64, of which half the area is small, four pictures took as long as
// with small ones alone, to 1 %; with 32 up to 1.1 times as long, and twice where what is hard lies in the
// upper half.
constexpr int kFewestOfProcessor = 48;
// Fewer rows can't be told apart into such that come first and such that come last.
constexpr int kFewestTaperingRows = 8;

}  // namespace

std::string SubpolygonGrid::text() const {
  return small_height > 0
             ? fmt::format("{} × {} and {} × {} smaller", columns, rows, small_columns, small_rows)
             : fmt::format("{} × {}", columns, rows);
}

DisplayPolygon SubpolygonGrid::polygon(SubpolygonId subpolygon) const {
  const bool is_large = subpolygon.value() < large_count();
  const int in_part = subpolygon.value() - (is_large ? 0 : large_count());
  const int part_columns = is_large ? columns : small_columns, part_rows = is_large ? rows : small_rows;
  const int part_top = is_large ? top : top + height - small_height,
            part_height = is_large ? height - small_height : small_height;
  const int column = in_part % part_columns, row = in_part / part_columns;
  return {static_cast<uint16_t>(left + boundary(width, part_columns, column)),
          static_cast<uint16_t>(part_top + boundary(part_height, part_rows, row)),
          static_cast<uint16_t>(left + boundary(width, part_columns, column + 1) - 1),
          static_cast<uint16_t>(part_top + boundary(part_height, part_rows, row + 1) - 1)};
}

std::optional<SubpolygonId> SubpolygonGrid::find(const DisplayPolygon& p) const {
  const int large_height = height - small_height;
  const bool is_large = p.top - top < large_height;
  const int column = cell_at(width, is_large ? columns : small_columns, p.left - left),
            row = is_large ? cell_at(large_height, rows, p.top - top)
                           : cell_at(small_height, small_rows, p.top - top - large_height);
  if (column < 0 || row < 0) return std::nullopt;
  const SubpolygonId subpolygon(is_large ? row * columns + column
                                         : large_count() + row * small_columns + column);
  return polygon(subpolygon) == p ? std::optional(subpolygon) : std::nullopt;
}

int64_t room_for(int width, int height, int least_side) {
  return int64_t{std::max(1, width / least_side)} * std::max(1, height / least_side);
}

SubpolygonGrid make_grid(int left, int top, int width, int height, int processors, int per_processor,
                         int least_side, size_t most_pixels) {
  double wanted = double(per_processor) * std::max(1, processors);
  while (true) {
    const SubpolygonGrid grid = best_grid(left, top, width, height, processors, wanted, least_side);
    const auto columns = size_t((width + grid.columns - 1) / grid.columns),
               rows = size_t((height + grid.rows - 1) / grid.rows);
    if (columns * rows <= most_pixels || wanted > double(width) * height) return grid;
    wanted *= std::max(1.1, double(columns) * double(rows) / double(most_pixels));
  }
}

SubpolygonGrid with_lower_rows(SubpolygonGrid grid, int most_height) {
  constexpr int kLeastColumns = 8;  // so that several nodes work on a row
  const int rows = (grid.height + most_height - 1) / most_height;
  if (rows <= grid.rows) return grid;
  grid.columns = std::min(grid.width, std::max(kLeastColumns, grid.count() / rows));
  grid.rows = rows;
  return grid;
}

SubpolygonGrid make_tapering_grid(int left, int top, int width, int height, int processors, int least_side,
                                  size_t most_pixels) {
  const SubpolygonGrid even =
      make_grid(left, top, width, height, processors, kSubpolygonsPerProcessor, least_side, most_pixels);
  if (int64_t{width} * height > int64_t{even.count()} * kLargeEnough_px ||
      even.count() < int64_t{kFewestOfProcessor} * processors || even.rows < kFewestTaperingRows)
    return even;
  const int small_height = height / 2;
  const SubpolygonGrid small =
      best_grid(left, top, width, small_height, processors, even.count() / 2.0, least_side);
  SubpolygonGrid grid =
      best_grid(left, top, width, height - small_height, processors, even.count() / 8.0, least_side);
  grid.height = height;
  grid.small_height = small_height;
  grid.small_columns = small.columns;
  grid.small_rows = small.rows;
  return grid;
}

SubpolygonId moved_right(const SubpolygonGrid& grid, SubpolygonId subpolygon, FrameIndex frames) {
  return SubpolygonId(static_cast<int>((int64_t{subpolygon.value()} + frames.value()) % grid.count()));
}

int interleaved_owner(const SubpolygonGrid& grid, SetPattern pattern, int processors, FrameIndex frame,
                      SubpolygonId subpolygon) {
  const int back = grid.count() - frame.value() % grid.count();
  const SubpolygonId at_first = moved_right(grid, subpolygon, FrameIndex(back));
  return pattern == SetPattern::rows ? at_first.value() % processors
                                     : lattice_owner(grid, processors, at_first);
}

std::vector<SubpolygonId> interleaved_set(const SubpolygonGrid& grid, SetPattern pattern, int processors,
                                          int processor) {
  std::vector<SubpolygonId> set;
  for (SubpolygonId s; s.value() < grid.count(); ++s)
    if (interleaved_owner(grid, pattern, processors, FrameIndex(0), s) == processor) set.push_back(s);
  return set;
}

}  // namespace rayfarm
