#pragma once
// All limits in time of the farm, in seconds, and what each depends on. Those of silence count time in which
// one listened (see ListeningClock).

#include <algorithm>

namespace rayfarm::liveness {

// What a job must live through.

/// The longest stop of a process, or of all of them.
inline constexpr double kLongestStop_s = 20;
/// The time in which a job ends that can't go on because a process was lost while loading.
inline constexpr double kLoadingLoss_s = 30;

// Turns.

/// The longest wait between two looks for messages of a process that has nothing else to do.
inline constexpr double kLongestNap_s = 0.004;
/// Between two looks for messages of a node that computes.
inline constexpr double kPoll_s = 0.01;
/// What an honest turn takes at most; the rest of a longer one was a pause of this process.
inline constexpr double kLongestTurn_s = 0.5;
/// Between two judgements of all nodes' silence.
inline constexpr double kTick_s = 0.1;
/// Between two looks at the process table, and at a watchdog's time.
inline constexpr double kLook_s = 0.25;
static_assert(kLongestNap_s < kPoll_s && kPoll_s < kLongestTurn_s);

// Silence.

/// Who lives says something at least so often, the heart if nothing else is to be said: twice in the shortest
/// silence that a user may set. Among many, see beat_s().
inline constexpr double kBeat_s = 1;
/// Beats that a host hears a second, and as many that it sends, where patience allows it.
inline constexpr double kMostBeatsPerSecond = 1000;
/// The longest of any number of nodes.
inline constexpr double kMostBeat_s = 8;
/// The shortest `--node-timeout`.
inline constexpr double kLeastNodeTimeout_s = 2 * kBeat_s;
/// The longest.
inline constexpr double kMostNodeTimeout_s = 3600;
/// A node that is silent for longer is lost to its host (`--node-timeout`): eight beats, where there are no
/// more than a thousand nodes. Being wrong costs little, as its work is done twice.
inline constexpr double kNodeTimeout_s = 8 * kBeat_s;
/// An idle node helps with what another has had in hand for so long since it last returned something.
inline constexpr double kHelp_s = 1;
/// A node doubts a host that is silent for longer than so many beats, and ends if its process is gone.
inline constexpr double kHostDoubtBeats = 6;
/// What no other sign confirms is believed after this long silence only: three times the longest stop.
inline constexpr double kLongSilence_s = 3 * kLongestStop_s;
/// All nodes are silent, but not known to be gone: the host waits so long for one to speak again. Longer than
/// the longest stop, and they are silent for kNodeTimeout_s before.
inline constexpr double kAllSilent_s = 30;
/// A process whose own work has looked for no message for so long hangs: its heart falls silent. Far longer
/// than any part of a computation that polls nothing takes.
inline constexpr double kStuck_s = 600;
static_assert(kLook_s < kBeat_s && kTick_s < kBeat_s);
static_assert(kLongestTurn_s < kBeat_s, "a pause of one's own counts as less than a missed beat");
static_assert(kLeastNodeTimeout_s <= kNodeTimeout_s && kNodeTimeout_s <= kMostNodeTimeout_s);
static_assert(kHostDoubtBeats * kMostBeat_s < kLongSilence_s);
static_assert(kAllSilent_s > kLongestStop_s + kMostBeat_s);
static_assert(kStuck_s > kLongSilence_s);

/// How often who lives says something in a job of so many nodes: more seldom the more there are, but four
/// times in the silence that is taken for a loss, if that is no shorter than by default.
constexpr double beat_s(int nodes, double node_timeout_s = kNodeTimeout_s) {
  const double most = std::max(kBeat_s, std::min(kMostBeat_s, node_timeout_s / 4));
  return std::clamp(nodes / kMostBeatsPerSecond, kBeat_s, most);
}
static_assert(beat_s(1 << 20, kLeastNodeTimeout_s) * 2 <= kLeastNodeTimeout_s);
static_assert(beat_s(1 << 20) * 4 <= kNodeTimeout_s);

// Loading: nobody can do without anybody.

/// A step that takes longer ends the job.
inline constexpr double kLoadingStep_s = 25;
/// Nodes wait longer than the host, which knows who is missing.
inline constexpr double kLoadingStepOfNodes_s = kLoadingStep_s + 4;
/// A node that finds its host gone lets it speak for so long: it may have ended the job itself.
inline constexpr double kGraceForHost_s = 3;
/// MPI starts so many processes within a step; each beyond them, that shares cores with others, adds this.
inline constexpr int kStartTogether = 8;
inline constexpr double kStartOfProcess_s = 0.5;
static_assert(kLoadingStep_s > kLongestStop_s + beat_s(1 << 20), "the plan, which may say more, comes last");
static_assert(kLoadingStepOfNodes_s < kLoadingLoss_s);
static_assert(kGraceForHost_s > kLook_s);

// The end.

/// Once the pictures are whole: a node that is silent for so long is not waited for.
inline constexpr double kLastWord_s = 3 * kBeat_s;
/// In which the host's last messages leave, and idle nodes hear them.
inline constexpr double kFarewell_s = 0.02;
/// MPI's own end, after which the process ends without it.
inline constexpr double kEnding_s = 10;
static_assert(kFarewell_s > 2 * kLongestNap_s);

}  // namespace rayfarm::liveness
