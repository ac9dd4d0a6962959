#pragma once
// Who traces what: a pure state machine. Events and the time go in, actions come out; it sends nothing and
// reads no clock, so that every fault can be played through in a test. Time is that of a ListeningClock, in
// which pauses of the host do not count. One machine, two policies:
//  - on demand: the host hands out subpolygons, two at each node, and gives what a slow or lost node holds to
//  others;
//  - interleaved (thesis 4.4.4.2): each node knows its own set; only what a lost node leaves behind is handed
//  out.
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "protocol/job_plan.h"

namespace rayfarm {

struct AssignmentOptions {
  AssignmentPolicy policy = AssignmentPolicy::on_demand;
  SubpolygonGrid grid;
  bool rotates = true;  ///< interleaved: sets move on from frame to frame
  int nodes = 1;
  int frames = 1;
  int window_frames = 3;  ///< frames begun but not yet released: bounds the host's memory
  int held_per_node = 2;
  int most_tries = 3;                               ///< of a subpolygon whose tracing fails
  double lost_after_s = liveness::kNodeTimeout_s;   ///< a node that is silent for so long is lost
  double give_up_after_s = liveness::kAllSilent_s;  ///< all nodes are lost, but one may return
  double duplicate_after_s = 1;  ///< an idle node helps with what another has held for at least so long
};

// Frames are indices into the job's sequence, nodes count from 1.
struct AssignSubpolygon {
  int node = 0, frame = 0, subpolygon = 0;
};
struct OpenFrames {  ///< interleaved: nodes may trace frames before `end`
  int end = 0;
};
struct FrameComplete {
  int frame = 0;
};
struct FrameFailed {
  int frame = 0;
  std::string problem;
};
struct NodeLost {
  int node = 0;
  bool had_work = false;  ///< which others do now
  bool is_expelled = false;
};
struct NodeReturned {  ///< a node thought lost was heard of again
  int node = 0;
};
struct AllNodesLost {};
using Action = std::variant<AssignSubpolygon, OpenFrames, FrameComplete, FrameFailed, NodeLost, NodeReturned,
                            AllNodesLost>;

class Assignment {
 public:
  Assignment(const AssignmentOptions& options, double now);

  /// A node gave a sign of life.
  void hear(int node, double now);
  /// A result came. False: a duplicate, or one of a frame that is over; drop it.
  bool accept(int node, int frame, int subpolygon, double now);
  /// A node could not trace a subpolygon.
  void fail(int node, int frame, int subpolygon, const std::string& problem, double now);
  /// A node failed: it is gone, could not load, or sends nonsense. Whatever it says from now on is dropped.
  void expel(int node, double now);
  /// A complete or failed frame needs no more memory.
  void release(int frame, double now);
  /// Time has passed.
  void tick(double now);

  /// What is to be done, in order; each is given once.
  std::vector<Action> take_actions() { return std::exchange(actions_, {}); }

  bool is_over() const { return released_ == options_.frames; }
  int nodes_alive() const;

 private:
  enum class State : uint8_t { closed, waiting, held, done };
  struct Subpolygon {
    State state = State::closed;
    int tries = 0;
    int failed_at = 0;         ///< the node at which the last try failed: another tries next
    double since = 0;          ///< when it was last handed out
    std::vector<int> holders;  ///< nodes; own sets of interleaved nodes too
  };
  struct Frame {
    std::vector<Subpolygon> subpolygons;
    int left = 0;
    bool is_over = false;  ///< complete or failed
    bool is_released = false;
  };
  struct Key {
    int frame, subpolygon;
    bool operator==(const Key&) const = default;
  };
  struct NodeState {
    bool is_lost = false;
    bool is_expelled = false;  ///< and stays lost
    double heard = 0;
    double freed = 0;           ///< when it last returned something
    std::vector<Key> assigned;  ///< handed out by the host, not yet returned
    int own_left = 0;           ///< of its own sets in open frames
  };

  /// A word of a node that is heard, about work that there is.
  bool is_credible(int node, int frame, int subpolygon);
  void open_frames(double now);
  void hand_out(double now);
  void give(int node, Key key, double now);
  std::optional<Key> next_waiting();
  std::optional<Key> oldest_held_by_another(int node, double now);
  void finish_subpolygon(Key key);
  void mark_lost(int node, double now);
  void give_up_without_nodes(double now);
  /// Interleaved: the node whose set holds the subpolygon.
  int owner_of(int frame, int subpolygon) const;
  bool is_own(int node, Key key) const;
  Subpolygon& at(Key key) {
    return frames_[static_cast<size_t>(key.frame)].subpolygons[static_cast<size_t>(key.subpolygon)];
  }
  NodeState& node_state(int node) { return nodes_[static_cast<size_t>(node) - 1]; }

  AssignmentOptions options_;
  std::vector<Frame> frames_;
  std::vector<NodeState> nodes_;
  std::deque<Key> waiting_;
  std::vector<Action> actions_;
  int opened_ = 0;    ///< frames before this index are open or over
  int released_ = 0;  ///< how many frames are released
  double all_lost_since_ = 0;
  bool is_given_up_ = false;
};

}  // namespace rayfarm
