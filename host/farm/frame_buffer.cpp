#include "host/farm/frame_buffer.h"

#include <cstring>

namespace rayfarm {

FrameBuffer::FrameBuffer(const PixelRect& window, size_t pixel_bytes, const SubpolygonGrid& grid,
                         size_t most_bytes)
    : window_(window),
      pixel_bytes_(pixel_bytes),
      row_bytes_(pixel_bytes * static_cast<size_t>(window.width())),
      grid_(grid),
      most_bytes_(most_bytes),
      is_streamed_(row_bytes_ * static_cast<size_t>(window.height()) > most_bytes),
      bands_(static_cast<size_t>(grid.row_count())),
      missing_(bands_.size()),
      is_there_(static_cast<size_t>(grid.count())) {
  for (int row = 0; row < grid.row_count(); ++row)
    missing_[static_cast<size_t>(row)] = grid.first_of_row(row + 1).value() - grid.first_of_row(row).value();
  make_room();
}

size_t FrameBuffer::bytes_of(int row) const {
  const DisplayPolygon p = grid_.polygon(grid_.first_of_row(row));
  return row_bytes_ * static_cast<size_t>(p.bottom - p.top + 1);
}

void FrameBuffer::make_room() {
  while (room_end_ < grid_.row_count()) {
    const size_t bytes = bytes_of(room_end_);
    if (is_streamed_ && room_end_ - gone_ >= 2 && held_ + bytes > most_bytes_) return;
    held_ += bytes;
    ++room_end_;
  }
}

void FrameBuffer::store(SubpolygonId subpolygon, std::span<const std::byte> pixels, bool is_final) {
  const int row_number = grid_.row_of(subpolygon);
  const auto row = static_cast<size_t>(row_number);
  auto& band = bands_[row];
  if (!band)
    band = std::make_shared<std::vector<std::byte>>(bytes_of(row_number));
  else if (!lent_.empty() && lent_[row] == band)
    band = std::make_shared<std::vector<std::byte>>(*band);
  const DisplayPolygon p = grid_.polygon(subpolygon);
  const size_t bytes = static_cast<size_t>(p.right - p.left + 1) * pixel_bytes_;
  std::byte* to = band->data() + static_cast<size_t>(p.left - window_.x0) * pixel_bytes_;
  const std::byte* from = pixels.data();
  for (int y = p.top; y <= p.bottom; ++y, to += row_bytes_, from += bytes) std::memcpy(to, from, bytes);
  is_there_[subpolygon.place()] = true;
  if (is_final) --missing_[row];
}

FrameBuffer::Band FrameBuffer::take_band() {
  if (taken_ == grid_.row_count() || missing_[static_cast<size_t>(taken_)] > 0) return nullptr;
  return bands_[static_cast<size_t>(taken_++)];
}

void FrameBuffer::let_go_band() {
  if (is_streamed_) {
    bands_[static_cast<size_t>(gone_)].reset();
    held_ -= bytes_of(gone_);
  }
  ++gone_;
  make_room();
}

std::vector<FrameBuffer::Band> FrameBuffer::lend() {
  lent_.assign(bands_.begin(), bands_.end());
  return lent_;
}

const std::byte* FrameBuffer::pixel(int x, int y) const {
  int row = 0, end = grid_.row_count();  // the last row that does not begin below y is in between
  while (end - row > 1) {
    const int middle = (row + end) / 2;
    (top_of(middle) <= y ? row : end) = middle;
  }
  return bands_[static_cast<size_t>(row)]->data() + static_cast<size_t>(y - top_of(row)) * row_bytes_ +
         static_cast<size_t>(x - window_.x0) * pixel_bytes_;
}

int FrameBuffer::top_of(int row) const {
  return grid_.polygon(grid_.first_of_row(row)).top;
}

}  // namespace rayfarm
