#include "host/view/subpolygon_queue.h"

#include <utility>

namespace rayfarm {

void SubpolygonQueue::push(const SeenSubpolygon& subpolygon) {
  const size_t size = subpolygon.pixels.size();
  {
    const std::lock_guard lock(mutex_);
    if (is_closed_ || (!items_.empty() && bytes_ + size > most_bytes_)) {
      ++dropped_;
      return;
    }
  }
  // Only one thread pushes, so there is room still when the copy is made.
  Item item{subpolygon, {subpolygon.pixels.begin(), subpolygon.pixels.end()}};
  item.subpolygon.pixels = item.pixels;
  {
    const std::lock_guard lock(mutex_);
    bytes_ += size;
    items_.push_back(std::move(item));
  }
  changed_.notify_one();
}

std::optional<SubpolygonQueue::Item> SubpolygonQueue::pop() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return is_closed_ || !items_.empty(); });
  if (items_.empty()) return std::nullopt;
  Item item = std::move(items_.front());
  items_.pop_front();
  bytes_ -= item.pixels.size();
  return item;
}

void SubpolygonQueue::close() {
  {
    const std::lock_guard lock(mutex_);
    is_closed_ = true;
  }
  changed_.notify_all();
}

void SubpolygonQueue::abandon() {
  {
    const std::lock_guard lock(mutex_);
    is_closed_ = true;
    dropped_ += items_.size();
    items_.clear();
    bytes_ = 0;
  }
  changed_.notify_all();
}

uint64_t SubpolygonQueue::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

}  // namespace rayfarm
