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

void FrameWriter::submit(Job job) {
  {
    const std::lock_guard lock(mutex_);
    queue_.push_back(std::move(job));
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

void FrameWriter::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return is_ending_ || !queue_.empty(); });
    if (queue_.empty()) return;  // all is written, and no more comes
    const Job job = std::move(queue_.front());
    queue_.pop_front();
    lock.unlock();
    const auto begin = std::chrono::steady_clock::now();
    Written written;
    written.frame = job.frame;
    written.is_last_pass = job.is_last_pass;
    try {
      written.sha256 = sha256(job.image.pixels);
      written.is_black = std::all_of(job.image.pixels.begin(), job.image.pixels.end(),
                                     [](std::byte b) { return b == std::byte{0}; });
      write_image(job.path, job.image, job.attributes);
    } catch (const std::exception& e) {
      written.problem = e.what();
    }
    written.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    lock.lock();
    written_.push_back(std::move(written));
  }
}

}  // namespace rayfarm
