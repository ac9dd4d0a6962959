#pragma once
// How the display polygon is cut into subpolygons (about 64 per processor; thesis 4.4.4.2), and which of them
// a processor traces by itself when work is interleaved. Host and nodes compute both from the same numbers.
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "protocol/index.h"
#include "protocol/messages.h"

namespace rayfarm {

/// The grid of subpolygons over a rectangle of pixels; numbered row by row. Every row of them reaches from
/// the rectangle's left to its right.
struct SubpolygonGrid {
  int left = 0, top = 0, width = 0, height = 0;  ///< the rectangle, in pixels of the image
  int columns = 1, rows = 1;
  /// The lowest pixel rows may be a grid of their own, of smaller subpolygons: none if 0.
  int small_height = 0, small_columns = 0, small_rows = 0;

  bool operator==(const SubpolygonGrid&) const = default;
  int large_count() const { return columns * rows; }
  int count() const { return large_count() + small_columns * small_rows; }
  /// Rows of subpolygons, from the top, of both kinds.
  int row_count() const { return rows + small_rows; }
  int row_of(SubpolygonId subpolygon) const {
    const int beyond = subpolygon.value() - large_count();
    return beyond < 0 ? subpolygon.value() / columns : rows + beyond / small_columns;
  }
  /// Of the highest row, in pixels.
  int most_row_height() const {
    const auto each = [](int pixels, int parts) { return parts > 0 ? (pixels + parts - 1) / parts : 0; };
    return std::max(each(height - small_height, rows), each(small_height, small_rows));
  }
  /// The first subpolygon of a row; of the one after the last, what the count is.
  SubpolygonId first_of_row(int row) const {
    return SubpolygonId(row <= rows ? row * columns : large_count() + (row - rows) * small_columns);
  }
  /// Such as "12 × 9", or "6 × 4 and 12 × 3 smaller".
  std::string text() const;
  DisplayPolygon polygon(SubpolygonId subpolygon) const;
  /// The subpolygon with these corners, or nothing.
  std::optional<SubpolygonId> find(const DisplayPolygon& polygon) const;
};

/// The thesis's number of subpolygons for each processor.
inline constexpr int kSubpolygonsPerProcessor = 64;

/// Of a subpolygon that is returned as a block: smaller ones are mostly header.
inline constexpr int kLeastBlockSide_px = 8;

/// What a result may weigh: far below the 2 GiB of an MPI message, so that no node or net is busy for long
/// with one.
inline constexpr size_t kMostSubpolygonBytes = 64 << 20;

/// About so many subpolygons per processor, none narrower than `least_side` pixels unless the rectangle is,
/// none with more than `most_pixels`.
SubpolygonGrid make_grid(int left, int top, int width, int height, int processors,
                         int per_processor = kSubpolygonsPerProcessor, int least_side = kLeastBlockSide_px,
                         size_t most_pixels = kMostSubpolygonBytes / kPixelBytes);

/// The same rectangle in rows of subpolygons that are at most so high, and in at least eight columns where
/// they had to become lower.
SubpolygonGrid with_lower_rows(SubpolygonGrid grid, int most_height);

/// The same where work is handed out by number: if subpolygons would be small, and so mostly header, those of
/// the upper half are four times as large. They are handed out first, and the small ones of the lower half
/// last, so that nodes end together as they would with small ones alone (the idea of factoring: Hummel,
/// Schonberg, Flynn 1992, "Factoring: a method for scheduling parallel loops"). Not where there is no room
/// for about as many as are wanted: there a large one could be more than a processor's share.
SubpolygonGrid make_tapering_grid(int left, int top, int width, int height, int processors, int least_side,
                                  size_t most_pixels);

/// How many subpolygons of at least this side a rectangle has room for.
int64_t room_for(int width, int height, int least_side);

/// How the sets of subpolygons lie that processors trace by themselves.
enum class SetPattern : uint8_t {
  lattice,  ///< without short steps in any direction: a hard patch of any shape falls to all alike
  rows      ///< counted off row by row, one in every `processors`
};

/// The processor (0 to processors - 1) that traces a subpolygon of a frame. The sets are evenly spread over
/// the image, and from frame to frame each moves to the right: from the right edge to the left of the row
/// below, from the bottom right corner to the top left (thesis 4.4.4.2).
int interleaved_owner(const SubpolygonGrid& grid, SetPattern pattern, int processors, FrameIndex frame,
                      SubpolygonId subpolygon);

/// The subpolygons of one processor in the first frame, in order.
std::vector<SubpolygonId> interleaved_set(const SubpolygonGrid& grid, SetPattern pattern, int processors,
                                          int processor);

/// Where a subpolygon of a set is after so many frames.
SubpolygonId moved_right(const SubpolygonGrid& grid, SubpolygonId subpolygon, FrameIndex frames);

}  // namespace rayfarm
