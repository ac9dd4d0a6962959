#include "protocol/liveness.h"

#include <fmt/core.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>

#include "protocol/build_identity.h"
#include "protocol/clock.h"

namespace rayfarm {

namespace {

/// The file that a process runs, also after it was removed: one call of the system. Nothing if it runs none.
std::optional<std::pair<dev_t, ino_t>> program_of(const std::string& process) {
  struct stat file {};
  if (stat(("/proc/" + process + "/exe").c_str(), &file) != 0) return std::nullopt;
  return std::pair(file.st_dev, file.st_ino);
}

}  // namespace

bool runs_this_program(uint32_t pid) {
  static const auto own = program_of("self");
  return own && program_of(std::to_string(pid)) == own;
}

double ListeningClock::turn(double now_s) {
  if (last_s_ >= 0) listened_s_ += std::clamp(now_s - last_s_, 0.0, liveness::kLongestTurn_s);
  last_s_ = now_s;
  return listened_s_;
}

ProcessSign::ProcessSign(std::string machine, uint32_t pid)
    : machine_(std::move(machine)),
      pid_(pid),
      was_seen_(machine_ == machine_name() && runs_this_program(pid)) {}

bool ProcessSign::is_gone() const {
  return was_seen_ && !runs_this_program(pid_);
}

std::function<std::string()> make_witness(std::vector<std::pair<std::string, ProcessSign>> watched,
                                          double grace_s) {
  std::vector<double> gone_since(watched.size());  // 0: not gone
  return [watched = std::move(watched), since = std::move(gone_since), grace_s]() mutable {
    for (size_t i = 0; i < watched.size(); ++i) {
      const auto& [name, sign] = watched[i];
      if (!sign.is_gone()) continue;
      if (since[i] == 0) since[i] = now_s();
      if (now_s() - since[i] >= grace_s)
        return fmt::format("{} (process {} on {}) was lost while loading; the job ends", name, sign.pid(),
                           sign.machine());
    }
    return std::string();
  };
}

Heart::Heart(Transport& transport, double stuck_s)
    : transport_(transport),
      stuck_s_(stuck_s),
      thread_([this](const std::stop_token& end) { beat_until(end); }) {}

void Heart::beat(NodeId to) {
  try {
    transport_.send(to, Alive{});
  } catch (const std::exception&) {
    // Whoever is gone misses nothing, and whoever is there hears the next one.
  }
}

double Heart::beat_where_due() {
  // A little earlier than is due, so that many ends need no wake each.
  const double beat_s = transport_.beat_s(), slack_s = beat_s / 16, now = now_s();
  double next = now + liveness::kBeat_s;  // the plan of the job may say another period
  const auto look_at = [&](NodeId end) {
    double due = transport_.last_sent_s(end) + beat_s - slack_s;
    if (due <= now) {
      beat(end);
      due = now + beat_s - slack_s;
    }
    next = std::min(next, due);
  };
  if (transport_.is_host()) {
    for (NodeId node(1); node.value() <= transport_.node_count(); ++node) look_at(node);
  } else {
    look_at(kHost);
  }
  return std::max(next - now, slack_s);
}

void Heart::beat_until(const std::stop_token& end) {
  std::mutex mutex;
  std::condition_variable_any changed;
  std::unique_lock lock(mutex);
  while (!end.stop_requested()) {
    const bool is_stuck = now_s() - transport_.last_turn_s() > stuck_s_;
    const double wait_s = is_stuck ? liveness::kBeat_s : beat_where_due();
    changed.wait_for(lock, end, std::chrono::duration<double>(wait_s), [] { return false; });
  }
}

}  // namespace rayfarm
