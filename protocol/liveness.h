#pragma once
// Who is alive, in one place: how processes say so, how their silence is measured, and how long it may last.
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

#include "protocol/transport.h"

namespace rayfarm {

/// All limits, in seconds. Those of silence count time in which one listened.
namespace liveness {
/// Of the heart: twice in the shortest silence that a user may set.
inline constexpr double kBeat_s = 1;
/// The shortest `--node-timeout`.
inline constexpr double kLeastNodeTimeout_s = 2;
/// A node that is silent for longer is lost to its host (`--node-timeout`): eight beats. Being wrong costs
/// little, as its work is done twice.
inline constexpr double kNodeTimeout_s = 8;
/// An idle node helps with what another has had in hand for longer, without any returned result.
inline constexpr double kHelp_s = 1;
/// A node doubts a host that is silent for longer, and ends if its process is gone: six beats.
inline constexpr double kHostDoubt_s = 6;
/// Between two looks at the process table, and at a watchdog's time.
inline constexpr double kLook_s = 0.25;
/// What no other sign confirms is believed after this long silence only: three times the longest stop (20 s)
/// that a job must live through.
inline constexpr double kLongSilence_s = 60;
/// All nodes are silent, but not known to be gone: the host waits so long for one to speak again. Longer than
/// a stop of 20 s.
inline constexpr double kAllSilent_s = 30;
/// A process whose own work has looked for no message for so long hangs: its heart falls silent. Far longer
/// than any part of a computation that polls nothing takes.
inline constexpr double kStuck_s = 600;
/// While loading, nobody can do without anybody: a step that takes longer ends the job. Longer than a stop of
/// 20 s, and the job ends within 30 s.
inline constexpr double kLoadingStep_s = 25;
/// Nodes wait longer than the host, which knows who is missing.
inline constexpr double kLoadingStepOfNodes_s = kLoadingStep_s + 4;
/// Once the pictures are whole: a node that is silent for three beats is not waited for.
inline constexpr double kLastWord_s = 3 * kBeat_s;
/// A node that finds its host gone while loading lets it speak for so long: it may have ended the job itself.
inline constexpr double kGraceForHost_s = 3;
/// MPI's own end, after which the process ends without it.
inline constexpr double kEnding_s = 10;
}  // namespace liveness

/// The time in which a process listened: each turn adds the time since the turn before, but no more than an
/// honest turn takes. Of one thread.
class ListeningClock {
 public:
  /// To be called whenever one listens, before messages are taken up. Returns the time.
  double turn(double now_s);
  double now() const { return listened_s_; }

 private:
  static constexpr double kLongestTurn_s = 0.5;
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
/// exists and the transport's own thread takes a turn within `stuck_s`.
class Heart {
 public:
  explicit Heart(Transport& transport, double stuck_s = liveness::kStuck_s);

 private:
  void beat(NodeId to);
  void beat_until(const std::stop_token& end);
  Transport& transport_;
  double stuck_s_;
  std::jthread thread_;
};

}  // namespace rayfarm
