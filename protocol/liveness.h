#pragma once
// Who is alive, in one place: how processes say so, and how their silence is measured; how long it may last
// is in time_limits.h.
//  - A heart beats in a thread of its own, so that no computation can starve it. It tells of life, not of
//    progress.
//  - Silence is measured in time in which this process listened. A pause of its own (stopped and continued, a
//    long computation, a busy machine) is no silence of others.
//  - On the same machine the process table tells whether a silent process is gone.
//  - A node that is silent is lost: others do its work, and it is welcome when it speaks again. A node that
//    failed (its process is gone, it could not load, it sent nonsense) is expelled and stays so.
#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "protocol/time_limits.h"
#include "protocol/transport.h"

namespace rayfarm {

/// The time in which a process listened: each turn adds the time since the turn before, but no more than an
/// honest turn takes. Of one thread.
class ListeningClock {
 public:
  /// To be called whenever one listens, before messages are taken up. Returns the time.
  double turn(double now_s);
  double now() const { return listened_s_; }

 private:
  double last_s_ = -1;
  double listened_s_ = 0;
};

/// True if a process of this machine runs this program; one that ended but was not yet reaped runs none.
bool runs_this_program(uint32_t pid);

/// What the process table of this machine tells of another process of the job.
class ProcessSign {
 public:
  ProcessSign() = default;
  /// `machine` and `pid` are what the process said of itself.
  ProcessSign(std::string machine, uint32_t pid);
  /// True if the process was seen here once, running this program, and is gone now. Processes of other
  /// machines, or of other containers, are never seen.
  bool is_gone() const;
  /// False: it was never seen, and will never be gone.
  bool tells() const { return was_seen_; }
  const std::string& machine() const { return machine_; }
  uint32_t pid() const { return pid_; }

 private:
  std::string machine_;
  uint32_t pid_ = 0;
  bool was_seen_ = false;
};

/// Something to ask again and again: names the first of `watched` (what it is called, its sign) that has been
/// gone for `grace_s`, or nothing.
std::function<std::string()> make_witness(std::vector<std::pair<std::string, ProcessSign>> watched,
                                          double grace_s);

/// Tells the other side that this process is alive, the host every node, a node its host, as long as it
/// exists and the transport's own thread takes a turn within `stuck_s`. Who was sent something else within
/// Transport::beat_s() knows it.
class Heart {
 public:
  explicit Heart(Transport& transport, double stuck_s = liveness::kStuck_s);

 private:
  void beat(NodeId to);
  /// Returns how long to wait before the next time.
  double beat_where_due();
  void beat_until(const std::stop_token& end);
  Transport& transport_;
  double stuck_s_;
  std::jthread thread_;
};

}  // namespace rayfarm
