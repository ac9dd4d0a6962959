#include "host/farm/assignment.h"

#include <algorithm>

namespace rayfarm {

Assignment::Assignment(const AssignmentOptions& options, double now)
    : options_(options),
      frames_(static_cast<size_t>(options.frames)),
      nodes_(static_cast<size_t>(options.nodes)) {
  for (NodeState& node : nodes_) node.heard = node.freed = now;
  open_frames(now);
  hand_out(now);
}

int Assignment::nodes_alive() const {
  return static_cast<int>(
      std::count_if(nodes_.begin(), nodes_.end(), [](const NodeState& n) { return !n.is_lost; }));
}

int Assignment::owner_of(int frame, int subpolygon) const {
  return interleaved_owner(options_.grid, options_.nodes, options_.rotates ? frame : 0, subpolygon) + 1;
}

bool Assignment::is_own(int node, Key key) const {
  return options_.policy == AssignmentPolicy::interleaved && owner_of(key.frame, key.subpolygon) == node;
}

void Assignment::open_frames(double now) {
  const int before = opened_;
  // Frames are released in any order; the window counts those that still need memory.
  while (opened_ < options_.frames && opened_ - released_ < options_.window_frames) {
    Frame& frame = frames_[static_cast<size_t>(opened_)];
    frame.left = options_.grid.count();
    frame.subpolygons.resize(static_cast<size_t>(frame.left));
    for (int s = 0; s < frame.left; ++s) {
      Subpolygon& subpolygon = frame.subpolygons[static_cast<size_t>(s)];
      subpolygon.since = now;
      if (options_.policy == AssignmentPolicy::interleaved) {
        const int owner = owner_of(opened_, s);
        if (!node_state(owner).is_lost) {
          subpolygon.state = State::held;
          subpolygon.holders = {owner};
          ++node_state(owner).own_left;
          continue;
        }
      }
      subpolygon.state = State::waiting;
      waiting_.push_back({opened_, s});
    }
    ++opened_;
  }
  if (opened_ != before && options_.policy == AssignmentPolicy::interleaved)
    actions_.emplace_back(OpenFrames{opened_});
}

std::optional<Assignment::Key> Assignment::next_waiting() {
  while (!waiting_.empty()) {
    const Key key = waiting_.front();
    waiting_.pop_front();
    if (!frames_[static_cast<size_t>(key.frame)].is_over && at(key).state == State::waiting) return key;
  }
  return std::nullopt;
}

std::optional<Assignment::Key> Assignment::oldest_held_by_another(int node, double now) {
  std::optional<Key> best;
  for (int f = 0; f < opened_; ++f) {
    const Frame& frame = frames_[static_cast<size_t>(f)];
    if (frame.is_over) continue;
    for (int s = 0; s < static_cast<int>(frame.subpolygons.size()); ++s) {
      const Subpolygon& candidate = frame.subpolygons[static_cast<size_t>(s)];
      if (candidate.state != State::held || candidate.holders.size() != 1 || candidate.holders[0] == node)
        continue;
      // A node works through what it holds: it has had this one in hand since it last returned something.
      const double since = std::max(candidate.since, node_state(candidate.holders[0]).freed);
      if (now - since < options_.duplicate_after_s) continue;
      if (!best || candidate.since < at(*best).since) best = Key{f, s};
    }
    if (best) return best;  // earlier frames first: they hold the window
  }
  return best;
}

void Assignment::give(int node, Key key, double now) {
  Subpolygon& subpolygon = at(key);
  subpolygon.state = State::held;
  subpolygon.since = now;
  subpolygon.holders.push_back(node);
  node_state(node).assigned.push_back(key);
  actions_.emplace_back(AssignSubpolygon{node, key.frame, key.subpolygon});
}

void Assignment::hand_out(double now) {
  // Round by round, so that every node has one before any has two.
  for (int round = 1; round <= options_.held_per_node; ++round)
    for (int node = 1; node <= options_.nodes; ++node) {
      NodeState& state = node_state(node);
      if (state.is_lost || static_cast<int>(state.assigned.size()) >= round) continue;
      auto key = next_waiting();
      if (key && at(*key).failed_at == node && nodes_alive() > 1) {
        // What failed at a node goes to another, if there is one: this node takes the next.
        const Key failed = *key;
        key = next_waiting();
        waiting_.push_front(failed);
        if (!key) continue;
      }
      if (!key) break;
      give(node, *key, now);
    }
  for (int node = 1; node <= options_.nodes; ++node) {
    NodeState& state = node_state(node);
    if (state.is_lost || !state.assigned.empty() || state.own_left > 0) continue;
    if (const auto key = oldest_held_by_another(node, now)) give(node, *key, now);
  }
}

void Assignment::hear(int node, double now) {
  NodeState& state = node_state(node);
  if (state.is_expelled) return;
  state.heard = now;
  if (!state.is_lost) return;
  state.is_lost = false;
  state.freed = now;
  actions_.emplace_back(NodeReturned{node});
  hand_out(now);
}

void Assignment::finish_subpolygon(Key key) {
  Subpolygon& subpolygon = at(key);
  for (const int holder : subpolygon.holders) {
    if (is_own(holder, key) && !node_state(holder).is_lost) --node_state(holder).own_left;
  }
  subpolygon.holders = {};
  subpolygon.state = State::done;
}

bool Assignment::is_credible(int node, int frame, int subpolygon) {
  return frame >= 0 && frame < opened_ && subpolygon >= 0 && subpolygon < options_.grid.count() &&
         !node_state(node).is_expelled;
}

bool Assignment::accept(int node, int frame, int subpolygon, double now) {
  if (!is_credible(node, frame, subpolygon)) return false;
  hear(node, now);
  const Key key{frame, subpolygon};
  NodeState& state = node_state(node);
  state.freed = now;
  std::erase(state.assigned, key);
  Frame& f = frames_[static_cast<size_t>(frame)];
  const bool is_news = !f.is_over && at(key).state != State::done;
  if (is_news) {
    finish_subpolygon(key);
    if (--f.left == 0) {
      f.is_over = true;
      actions_.emplace_back(FrameComplete{frame});
    }
  }
  hand_out(now);
  return is_news;
}

void Assignment::fail(int node, int frame, int subpolygon, const std::string& problem, double now) {
  if (!is_credible(node, frame, subpolygon)) return;
  hear(node, now);
  const Key key{frame, subpolygon};
  std::erase(node_state(node).assigned, key);
  Frame& f = frames_[static_cast<size_t>(frame)];
  if (!f.is_over && at(key).state != State::done) {
    Subpolygon& s = at(key);
    if (++s.tries >= options_.most_tries) {
      f.is_over = true;
      for (int i = 0; i < options_.grid.count(); ++i) finish_subpolygon({frame, i});
      actions_.emplace_back(FrameFailed{frame, problem});
    } else {
      if (std::erase(s.holders, node) > 0 && is_own(node, key)) --node_state(node).own_left;
      s.failed_at = node;
      if (s.holders.empty()) {
        s.state = State::waiting;
        waiting_.push_front(key);
      }
    }
  }
  hand_out(now);
}

void Assignment::mark_lost(int node, double now) {
  NodeState& state = node_state(node);
  if (state.is_lost) return;
  state.is_lost = true;
  actions_.emplace_back(NodeLost{node, !state.assigned.empty() || state.own_left > 0, state.is_expelled});
  state.own_left = 0;
  state.assigned.clear();
  std::deque<Key> orphans;
  for (int f = 0; f < opened_; ++f) {
    Frame& frame = frames_[static_cast<size_t>(f)];
    if (frame.is_over) continue;
    for (int s = 0; s < options_.grid.count(); ++s) {
      Subpolygon& subpolygon = frame.subpolygons[static_cast<size_t>(s)];
      if (subpolygon.state != State::held || std::erase(subpolygon.holders, node) == 0) continue;
      if (!subpolygon.holders.empty()) continue;  // another has it too
      subpolygon.state = State::waiting;
      orphans.push_back({f, s});
    }
  }
  waiting_.insert(waiting_.begin(), orphans.begin(), orphans.end());
  if (nodes_alive() == 0) all_lost_since_ = now;
  hand_out(now);
}

void Assignment::give_up_without_nodes(double now) {
  if (is_given_up_ || nodes_alive() > 0) return;
  const bool one_may_return =
      std::any_of(nodes_.begin(), nodes_.end(), [](const NodeState& n) { return !n.is_expelled; });
  if (one_may_return && now - all_lost_since_ < options_.give_up_after_s) return;
  is_given_up_ = true;
  actions_.emplace_back(AllNodesLost{});
}

void Assignment::expel(int node, double now) {
  if (std::exchange(node_state(node).is_expelled, true)) return;
  mark_lost(node, now);
  give_up_without_nodes(now);
}

void Assignment::release(int frame, double now) {
  Frame& f = frames_[static_cast<size_t>(frame)];
  if (f.is_released) return;
  f.is_released = true;
  f.subpolygons = {};
  ++released_;
  open_frames(now);
  hand_out(now);
}

void Assignment::tick(double now) {
  for (int node = 1; node <= options_.nodes; ++node)
    if (now - node_state(node).heard > options_.lost_after_s) mark_lost(node, now);
  give_up_without_nodes(now);
  hand_out(now);
}

}  // namespace rayfarm
