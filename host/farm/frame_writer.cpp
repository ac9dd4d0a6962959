#include "host/farm/frame_writer.h"

#include <algorithm>
#include <chrono>

namespace rayfarm {

FrameWriter::FrameWriter() : thread_([this] { run(); }) {}

FrameWriter::~FrameWriter() {
  finish();
}

void FrameWriter::finish() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

PictureInWriting FrameWriter::begin(Job job) {
  const PictureInWriting picture = next_;
  ++next_;
  submit({picture, Begin{std::move(job)}});
  return picture;
}

void FrameWriter::write(PictureInWriting picture, std::shared_ptr<const std::vector<std::byte>> rows) {
  submit({picture, Band{std::move(rows)}});
}

void FrameWriter::end(PictureInWriting picture, std::map<std::string, std::string> late) {
  submit({picture, End{std::move(late)}});
}

void FrameWriter::drop(PictureInWriting picture) {
  {
    // What waits of it would only be written to be removed.
    const std::lock_guard lock(mutex_);
    std::erase_if(queue_, [picture](const Order& order) {
      return order.picture == picture && std::holds_alternative<Band>(order.what);
    });
  }
  submit({picture, Drop{}});
}

void FrameWriter::submit(Order order) {
  {
    const std::lock_guard lock(mutex_);
    queue_.push_back(std::move(order));
  }
  changed_.notify_all();
}

std::optional<FrameWriter::Written> FrameWriter::try_take() {
  const std::lock_guard lock(mutex_);
  if (written_.empty()) return std::nullopt;
  Written written = std::move(written_.front());
  written_.pop_front();
  return written;
}

std::optional<FrameWriter::BandWritten> FrameWriter::try_take_band() {
  const std::lock_guard lock(mutex_);
  if (bands_.empty()) return std::nullopt;
  const BandWritten band = bands_.front();
  bands_.pop_front();
  return band;
}

void FrameWriter::run() {
  while (true) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return is_ending_ || !queue_.empty(); });
    if (queue_.empty()) break;  // all is written, and no more comes
    Order order = std::move(queue_.front());
    queue_.pop_front();
    lock.unlock();
    carry_out(std::move(order));
  }
  open_.clear();
}

void FrameWriter::take(Open& open, const Begin& begin) {
  const Job& job = begin.job;
  open.written.frame = job.frame;
  open.written.is_last_pass = job.is_last_pass;
  open.written.is_black = true;
  open.row_bytes = static_cast<size_t>(job.image.window.width()) * job.image.layout.bytes;
  open.writer = std::make_unique<ImageWriter>(job.path, job.image, job.attributes, job.late);
}

void FrameWriter::take(Open& open, const Band& band) {
  if (!open.writer) return;
  open.sum.update(*band.rows);
  open.written.is_black &=
      std::all_of(band.rows->begin(), band.rows->end(), [](std::byte b) { return b == std::byte{0}; });
  open.writer->write_rows(*band.rows);
}

void FrameWriter::take(Open& open, const End& end) {
  if (!open.writer) return;
  open.writer->finish(end.late);
  open.written.sha256 = open.sum.digest();
}

void FrameWriter::carry_out(Order order) {
  const auto begin = std::chrono::steady_clock::now();
  Open& open = open_[order.picture];
  Written& written = open.written;
  written.picture = order.picture;
  const bool is_end = std::holds_alternative<End>(order.what);
  bool is_told = is_end && written.problem.empty();
  try {
    std::visit([&](const auto& what) { take(open, what); }, order.what);
  } catch (const std::exception& e) {
    open.writer.reset();
    written.problem = e.what();
    written.is_black = false;
    is_told = true;
  }
  std::optional<BandWritten> of_band;
  if (auto* const band = std::get_if<Band>(&order.what)) {
    of_band = {written.frame, static_cast<int>(band->rows->size() / open.row_bytes), order.picture};
    band->rows.reset();  // before it is said
  }
  written.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  {
    const std::lock_guard lock(mutex_);
    if (of_band) bands_.push_back(*of_band);
    if (is_told) written_.push_back(written);
  }
  if (is_end || std::holds_alternative<Drop>(order.what)) open_.erase(order.picture);
}

}  // namespace rayfarm
