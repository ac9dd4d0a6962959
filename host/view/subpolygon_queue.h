#pragma once
// Results on their way from the host's thread to that of a watcher: copied, because their bytes go, and
// bounded, because a watcher may be slow. What finds no room is dropped, and counted: the host never waits.
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <vector>

#include "host/view/watcher.h"

namespace rayfarm {

class SubpolygonQueue {
 public:
  /// Holds so many bytes of pixels, or one result that is larger.
  explicit SubpolygonQueue(size_t most_bytes = size_t{256} << 20) : most_bytes_(most_bytes) {}

  struct Item {
    SeenSubpolygon subpolygon;      ///< its pixels are those below
    std::vector<std::byte> pixels;  ///< moved with the item, so that they stay where they are
  };

  void push(const SeenSubpolygon& subpolygon);
  /// Waits for the next. Nothing: the queue was closed, and is empty.
  std::optional<Item> pop();
  /// Nothing more will come.
  void close();
  /// What is still there is dropped, too.
  void abandon();
  uint64_t dropped() const;

 private:
  const size_t most_bytes_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Item> items_;
  size_t bytes_ = 0;
  uint64_t dropped_ = 0;
  bool is_closed_ = false;
};

}  // namespace rayfarm
