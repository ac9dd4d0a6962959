#pragma once
// The pixels of a picture in the making. They lie in bands, a row of subpolygons each: whole bands leave for
// the picture's file from the top, and a picture that is larger than the memory it may take keeps no more of
// them than it must.
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "common/image/pixel_rect.h"
#include "protocol/subpolygons.h"

namespace rayfarm {

class FrameBuffer {
 public:
  using Band = std::shared_ptr<const std::vector<std::byte>>;

  /// `window`: the pixels that the grid divides. `most_bytes`: of bands in memory at a time; two of them
  /// there always are.
  FrameBuffer(const PixelRect& window, size_t pixel_bytes, const SubpolygonGrid& grid, size_t most_bytes);

  /// True if bands that were written are let go, because the picture takes more than `most_bytes`.
  bool is_streamed() const { return is_streamed_; }
  /// Subpolygons before this one may come.
  SubpolygonId end_of_room() const { return grid_.first_of_row(room_end_); }
  const SubpolygonGrid& grid() const { return grid_; }

  /// `pixels`: rows of the subpolygon, from the top. It comes once with those that stay, `is_final`.
  void store(SubpolygonId subpolygon, std::span<const std::byte> pixels, bool is_final);
  /// True if it has come, final or not.
  bool is_there(SubpolygonId subpolygon) const { return is_there_[subpolygon.place()]; }
  /// The next band from the top, once all of it is final; null: it is not, or all have been taken.
  Band take_band();
  /// The first of the bands that were taken needs no more memory, for all that its taker cares.
  void let_go_band();
  /// All bands, to be looked at until `end_lending`: what comes meanwhile goes to copies.
  std::vector<Band> lend();
  void end_lending() { lent_.clear(); }

  /// A pixel of a subpolygon that is there, in the image's coordinates. Not of a band that was let go.
  const std::byte* pixel(int x, int y) const;

 private:
  int top_of(int row) const;
  size_t bytes_of(int row) const;
  void make_room();

  PixelRect window_;
  size_t pixel_bytes_, row_bytes_;
  SubpolygonGrid grid_;
  size_t most_bytes_;
  bool is_streamed_ = false;
  std::vector<std::shared_ptr<std::vector<std::byte>>>
      bands_;                   ///< by row; null: nothing has come, or it is gone
  std::vector<int> missing_;    ///< by row: final subpolygons
  std::vector<bool> is_there_;  ///< by subpolygon
  std::vector<Band> lent_;
  int taken_ = 0;     ///< bands from the top
  int gone_ = 0;      ///< of these, needed no more
  int room_end_ = 0;  ///< rows that may be in memory end before this one
  size_t held_ = 0;   ///< bytes that rows from gone_ to room_end_ take
};

}  // namespace rayfarm
