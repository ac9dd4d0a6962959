#pragma once
// Counts every message by command, direction and node. The host's transport owns one; nothing passes it
// uncounted. Any thread may use it.
#include <array>
#include <mutex>
#include <vector>

#include "protocol/messages.h"

namespace rayfarm {

struct Traffic {
  uint64_t messages = 0;
  uint64_t bytes = 0;
  Traffic& operator+=(const Traffic& t) {
    messages += t.messages;
    bytes += t.bytes;
    return *this;
  }
};

enum class Direction : uint8_t { to_node, to_host };

class TrafficMeter {
 public:
  explicit TrafficMeter(int nodes) : command_(static_cast<size_t>(nodes) + 1), control_(command_.size()) {}

  /// `node` counts from 1; 0 stands for a broadcast, which the net carries once (thesis: to all in parallel).
  void count_command(NodeId node, Direction direction, Command command, const Traffic& traffic) {
    const std::lock_guard lock(mutex_);
    command_[node.place()][static_cast<size_t>(direction)][static_cast<size_t>(command)] += traffic;
  }
  void count_control(NodeId node, Direction direction, const Traffic& traffic) {
    const std::lock_guard lock(mutex_);
    control_[node.place()][static_cast<size_t>(direction)] += traffic;
  }

  /// All of a command, both directions and every node.
  Traffic total(Command command) const {
    const std::lock_guard lock(mutex_);
    Traffic sum;
    for (const auto& node : command_)
      for (const auto& direction : node) sum += direction[static_cast<size_t>(command)];
    return sum;
  }
  Traffic total_control() const {
    const std::lock_guard lock(mutex_);
    Traffic sum;
    for (const auto& node : control_)
      for (const Traffic& direction : node) sum += direction;
    return sum;
  }
  /// All that one node sent or was sent alone.
  Traffic of_node(NodeId node, Direction direction) const {
    const std::lock_guard lock(mutex_);
    Traffic sum = control_[node.place()][static_cast<size_t>(direction)];
    for (const Traffic& t : command_[node.place()][static_cast<size_t>(direction)]) sum += t;
    return sum;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::array<std::array<Traffic, kCommands>, 2>> command_;
  std::vector<std::array<Traffic, 2>> control_;
};

}  // namespace rayfarm
