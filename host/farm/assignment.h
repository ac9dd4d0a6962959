#pragma once
// Who does what of a job's phases, one after the other: a pure state machine. Events and the time go in,
// actions come out; it sends nothing and reads no clock, so that every fault can be played through in a test.
// Time is that of a ListeningClock, in which pauses of the host do not count. It knows no more of the work
// than how many items each step has. What a result costs does not depend on how many nodes there are, or how
// many of them wait, but for the logarithm of the number of those that are slow. One machine, two policies:
//  - on demand: the host hands out items, two at each node, and gives what a slow or lost node holds to
//  others;
//  - interleaved (thesis 4.4.4.2): each node knows its own items; only what a lost node leaves behind is
//  handed
//    out.
#include <array>
#include <deque>
#include <functional>
#include <limits>
#include <optional>
#include <queue>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "host/farm/node_set.h"
#include "protocol/index.h"
#include "protocol/time_limits.h"

namespace rayfarm {

/// The work of a phase.
struct PhaseWork {
  int steps = 1;
  int items_per_step = 1;
  int window_steps = 3;  ///< steps begun but not yet released: bounds the host's memory
  /// Interleaved: the node that does an item by itself; empty: all is handed out on demand.
  std::function<NodeId(ItemIndex)> owner_of;
  std::function<bool(ItemIndex)> is_done;  ///< asked when its step begins; empty: nothing is
  /// What is handed out comes before this item (see Assignment::allow_before): bounds the host's memory
  /// within a step. A node's own items are bounded by the steps alone.
  ItemIndex allowed_end{std::numeric_limits<int64_t>::max()};
};

/// Of the net, and the work of the first phase.
struct AssignmentOptions : PhaseWork {
  int nodes = 1;
  int held_per_node = 2;
  int most_tries = 3;                               ///< of an item that fails
  double lost_after_s = liveness::kNodeTimeout_s;   ///< a node that is silent for so long is lost
  double give_up_after_s = liveness::kAllSilent_s;  ///< all nodes are lost, but one may return
  double duplicate_after_s = liveness::kHelp_s;  ///< an idle node helps with what another holds for so long
};

struct AssignItem {
  NodeId node;
  ItemIndex item;
};
/// Interleaved: nodes may do their items of the steps before `end`.
struct OpenedSteps {
  StepIndex end;
};
struct StepComplete {
  StepIndex step;
};
struct StepFailed {
  StepIndex step;
  std::string problem;
};
struct NodeLost {
  NodeId node;
  bool had_work = false;  ///< which others do now
  bool is_expelled = false;
};
/// A node thought lost was heard of again.
struct NodeReturned {
  NodeId node;
};
struct AllNodesLost {};
using Action =
    std::variant<AssignItem, OpenedSteps, StepComplete, StepFailed, NodeLost, NodeReturned, AllNodesLost>;

class Assignment {
 public:
  Assignment(const AssignmentOptions& options, double now);

  /// The next phase, when one is over. Nodes stay what they are: those lost may return, those expelled may
  /// not.
  void begin(const PhaseWork& work, double now);

  /// A node gave a sign of life.
  void hear(NodeId node, double now);
  /// True if such a result would be news.
  bool needs(NodeId node, ItemIndex item);
  /// A result came. False: a duplicate, or one of a step that is over; drop it.
  bool accept(NodeId node, ItemIndex item, double now);
  /// A node could not do an item.
  void fail(NodeId node, ItemIndex item, const std::string& problem, double now);
  /// A node failed: it is gone, could not load, or sends nonsense. Whatever it says from now on is dropped.
  void expel(NodeId node, double now);
  /// Items up to this one may be handed out, too.
  void allow_before(ItemIndex end, double now);
  /// Nothing can be made of a step any more: its items are dropped. It is to be released as one that failed.
  void abandon(StepIndex step, double now);
  /// A complete or failed step needs no more memory.
  void release(StepIndex step, double now);
  /// Time has passed.
  void tick(double now);

  /// What is to be done, in order; each is given once.
  std::vector<Action> take_actions() { return std::exchange(actions_, {}); }

  bool is_over() const { return released_ == options_.steps; }
  int nodes_alive() const { return alive_; }
  bool is_expelled(NodeId node) const { return nodes_[node.place() - 1].is_expelled; }
  bool has_work(NodeId node) const { return nodes_[node.place() - 1].has_work(); }

 private:
  enum class State : uint8_t { closed, waiting, held, done };
  /// 24 bytes: a frame may be cut into as many items as it has pixels.
  struct Item {
    double since = 0;               ///< when it was last handed out
    std::array<NodeId, 2> holders;  ///< owners of interleaved items too; node 0 holds nothing
    NodeId failed_at;               ///< the node at which the last try failed: another tries next
    uint8_t tries = 0;
    State state = State::closed;

    bool is_held_by(NodeId node) const { return holders[0] == node || holders[1] == node; }
    int holder_count() const { return (holders[0] != NodeId() ? 1 : 0) + (holders[1] != NodeId() ? 1 : 0); }
    void add_holder(NodeId node) { holders[holders[0] == NodeId() ? 0 : 1] = node; }
    /// False: it was none.
    bool drop_holder(NodeId node) {
      if (!is_held_by(node)) return false;
      holders[holders[0] == node ? 0 : 1] = NodeId();
      return true;
    }
  };
  struct Step {
    std::vector<Item> items;
    int left = 0;
    bool is_over = false;  ///< complete or failed
    bool is_released = false;
  };
  struct NodeState {
    bool is_lost = false;
    bool is_expelled = false;  ///< and stays lost
    bool is_watched = false;   ///< stands once in watched_ or slow_
    double heard = 0;
    double freed = 0;                 ///< when it last returned something
    std::vector<ItemIndex> assigned;  ///< handed out by the host, not yet returned
    /// Interleaved: its own items of open steps that nobody helps with, in order; some may be done.
    std::deque<ItemIndex> own;
    std::vector<ItemIndex> helped;  ///< interleaved: its own items that others do, too; some may be done
    int own_left = 0;               ///< of its own, not yet done

    bool has_work() const { return !assigned.empty() || own_left > 0; }
  };
  /// What a slow node may be helped with. Earlier steps first: they hold the window.
  using Help = std::tuple<StepIndex, double, ItemIndex, NodeId>;  ///< the item's step, since when it is held
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  /// A word of a node that is heard, about work that there is.
  bool is_credible(NodeId node, ItemIndex item);
  void open_steps(double now);
  void hand_out(double now);
  void help_if_idle(NodeId node, double now);
  /// Brings the sets of nodes with room, and of idle ones, up to date.
  void update_room(NodeId node);
  void give(NodeId node, ItemIndex item, double now);
  std::optional<ItemIndex> next_waiting();
  void watch(NodeId node);
  double slow_from(NodeId node);
  std::optional<Help> help_for(NodeId node, double now);
  std::optional<ItemIndex> next_to_help(double now);
  void leave(ItemIndex item, NodeId node);
  bool is_done(ItemIndex item);
  bool is_held_alone(ItemIndex item, NodeId by);
  void finish_item(ItemIndex item);
  void end_step(StepIndex step);
  void mark_lost(NodeId node, double now);
  void give_up_without_nodes(double now);
  bool is_own(NodeId node, ItemIndex item) const {
    return options_.owner_of && options_.owner_of(item) == node;
  }
  ItemIndex first_of(StepIndex step) const {
    return ItemIndex(int64_t{step.value()} * options_.items_per_step);
  }
  StepIndex step_of(ItemIndex item) const {
    return StepIndex(static_cast<int>(item.value() / options_.items_per_step));
  }
  Step& at(StepIndex step) { return steps_[step.place()]; }
  Item& at(ItemIndex item) {
    return at(step_of(item)).items[static_cast<size_t>(item.value() % options_.items_per_step)];
  }
  NodeState& node_state(NodeId node) { return nodes_[node.place() - 1]; }

  AssignmentOptions options_;
  std::vector<Step> steps_;
  std::vector<NodeState> nodes_;
  std::deque<ItemIndex> waiting_;
  std::vector<NodeSet> with_room_;  ///< nodes that may be given more, by how many each is assigned
  NodeSet idle_;                    ///< those that have nothing at all
  int alive_ = 0;
  /// Nodes with work, by the time from which each counts as slow or an earlier one, and those that are slow.
  /// What stands there is put right when it comes to the front, not when it changes: most change long before.
  std::priority_queue<std::pair<double, NodeId>, std::vector<std::pair<double, NodeId>>, std::greater<>>
      watched_;
  std::set<Help> slow_;
  std::vector<Action> actions_;
  StepIndex opened_;  ///< steps before this are open or over
  int released_ = 0;  ///< how many steps are released
  double all_lost_since_ = 0;
  bool is_given_up_ = false;
};

}  // namespace rayfarm
