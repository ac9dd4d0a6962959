#include "host/farm/assignment.h"

#include <algorithm>

namespace rayfarm {

Assignment::Assignment(const AssignmentOptions& options, double now)
    : options_(options),
      steps_(static_cast<size_t>(options.steps)),
      nodes_(static_cast<size_t>(options.nodes)) {
  for (NodeState& node : nodes_) node.heard = node.freed = now;
  open_steps(now);
  hand_out(now);
}

int Assignment::nodes_alive() const {
  return static_cast<int>(
      std::count_if(nodes_.begin(), nodes_.end(), [](const NodeState& n) { return !n.is_lost; }));
}

bool Assignment::is_own(NodeId node, ItemIndex item) const {
  return options_.owner_of && options_.owner_of(item) == node;
}

void Assignment::open_steps(double now) {
  const StepIndex before = opened_;
  // Steps are released in any order; the window counts those that still need memory.
  while (opened_.value() < options_.steps && opened_.value() - released_ < options_.window_steps) {
    Step& step = at(opened_);
    step.left = options_.items_per_step;
    step.items.resize(static_cast<size_t>(step.left));
    ItemIndex index = first_of(opened_);
    for (Item& item : step.items) {
      item.since = now;
      const NodeId owner = options_.owner_of ? options_.owner_of(index) : NodeId();
      if (options_.owner_of && !node_state(owner).is_lost) {
        item.state = State::held;
        item.holders = {owner};
        ++node_state(owner).own_left;
      } else {
        item.state = State::waiting;
        waiting_.push_back(index);
      }
      ++index;
    }
    ++opened_;
  }
  if (opened_ != before && options_.owner_of) actions_.emplace_back(OpenedSteps{opened_});
}

std::optional<ItemIndex> Assignment::next_waiting() {
  while (!waiting_.empty()) {
    const ItemIndex item = waiting_.front();
    waiting_.pop_front();
    if (!at(step_of(item)).is_over && at(item).state == State::waiting) return item;
  }
  return std::nullopt;
}

std::optional<ItemIndex> Assignment::oldest_held_by_another(NodeId node, double now) {
  std::optional<ItemIndex> best;
  for (StepIndex s; s < opened_; ++s) {
    if (at(s).is_over) continue;
    ItemIndex index = first_of(s);
    for (const Item& candidate : at(s).items) {
      const ItemIndex item = index;
      ++index;
      if (candidate.state != State::held || candidate.holders.size() != 1 || candidate.holders[0] == node)
        continue;
      // A node works through what it holds: it has had this one in hand since it last returned something.
      const double since = std::max(candidate.since, node_state(candidate.holders[0]).freed);
      if (now - since < options_.duplicate_after_s) continue;
      if (!best || candidate.since < at(*best).since) best = item;
    }
    if (best) return best;  // earlier steps first: they hold the window
  }
  return best;
}

void Assignment::give(NodeId node, ItemIndex index, double now) {
  Item& item = at(index);
  item.state = State::held;
  item.since = now;
  item.holders.push_back(node);
  node_state(node).assigned.push_back(index);
  actions_.emplace_back(AssignItem{node, index});
}

void Assignment::hand_out(double now) {
  // Round by round, so that every node has one before any has two.
  for (int round = 1; round <= options_.held_per_node; ++round)
    for (NodeId node(1); node.value() <= options_.nodes; ++node) {
      NodeState& state = node_state(node);
      if (state.is_lost || static_cast<int>(state.assigned.size()) >= round) continue;
      auto item = next_waiting();
      if (item && at(*item).failed_at == node && nodes_alive() > 1) {
        // What failed at a node goes to another, if there is one: this node takes the next.
        const ItemIndex failed = *item;
        item = next_waiting();
        waiting_.push_front(failed);
        if (!item) continue;
      }
      if (!item) break;
      give(node, *item, now);
    }
  for (NodeId node(1); node.value() <= options_.nodes; ++node) {
    NodeState& state = node_state(node);
    if (state.is_lost || !state.assigned.empty() || state.own_left > 0) continue;
    if (const auto item = oldest_held_by_another(node, now)) give(node, *item, now);
  }
}

void Assignment::hear(NodeId node, double now) {
  NodeState& state = node_state(node);
  if (state.is_expelled) return;
  state.heard = now;
  if (!state.is_lost) return;
  state.is_lost = false;
  state.freed = now;
  actions_.emplace_back(NodeReturned{node});
  hand_out(now);
}

void Assignment::finish_item(ItemIndex index) {
  Item& item = at(index);
  for (const NodeId holder : item.holders) {
    if (is_own(holder, index) && !node_state(holder).is_lost) --node_state(holder).own_left;
  }
  item.holders = {};
  item.state = State::done;
}

bool Assignment::is_credible(NodeId node, ItemIndex item) {
  return item >= ItemIndex(0) && item < first_of(opened_) && !node_state(node).is_expelled;
}

bool Assignment::accept(NodeId node, ItemIndex item, double now) {
  if (!is_credible(node, item)) return false;
  hear(node, now);
  NodeState& state = node_state(node);
  state.freed = now;
  std::erase(state.assigned, item);
  Step& step = at(step_of(item));
  const bool is_news = !step.is_over && at(item).state != State::done;
  if (is_news) {
    finish_item(item);
    if (--step.left == 0) {
      step.is_over = true;
      actions_.emplace_back(StepComplete{step_of(item)});
    }
  }
  hand_out(now);
  return is_news;
}

void Assignment::fail(NodeId node, ItemIndex index, const std::string& problem, double now) {
  if (!is_credible(node, index)) return;
  hear(node, now);
  std::erase(node_state(node).assigned, index);
  Step& step = at(step_of(index));
  if (!step.is_over && at(index).state != State::done) {
    Item& item = at(index);
    if (++item.tries >= options_.most_tries) {
      step.is_over = true;
      const StepIndex failed = step_of(index);
      for (ItemIndex i = first_of(failed); i < first_of(StepIndex(failed.value() + 1)); ++i) finish_item(i);
      actions_.emplace_back(StepFailed{failed, problem});
    } else {
      if (std::erase(item.holders, node) > 0 && is_own(node, index)) --node_state(node).own_left;
      item.failed_at = node;
      if (item.holders.empty()) {
        item.state = State::waiting;
        waiting_.push_front(index);
      }
    }
  }
  hand_out(now);
}

void Assignment::mark_lost(NodeId node, double now) {
  NodeState& state = node_state(node);
  if (state.is_lost) return;
  state.is_lost = true;
  actions_.emplace_back(NodeLost{node, !state.assigned.empty() || state.own_left > 0, state.is_expelled});
  state.own_left = 0;
  state.assigned.clear();
  std::deque<ItemIndex> orphans;
  for (StepIndex s; s < opened_; ++s) {
    if (at(s).is_over) continue;
    ItemIndex index = first_of(s);
    for (Item& item : at(s).items) {
      const bool was_its = item.state == State::held && std::erase(item.holders, node) > 0;
      if (was_its && item.holders.empty()) {  // else another has it too
        item.state = State::waiting;
        orphans.push_back(index);
      }
      ++index;
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

void Assignment::expel(NodeId node, double now) {
  if (std::exchange(node_state(node).is_expelled, true)) return;
  mark_lost(node, now);
  give_up_without_nodes(now);
}

void Assignment::release(StepIndex index, double now) {
  Step& step = at(index);
  if (step.is_released) return;
  step.is_released = true;
  step.items = {};
  ++released_;
  open_steps(now);
  hand_out(now);
}

void Assignment::tick(double now) {
  for (NodeId node(1); node.value() <= options_.nodes; ++node)
    if (now - node_state(node).heard > options_.lost_after_s) mark_lost(node, now);
  give_up_without_nodes(now);
  hand_out(now);
}

}  // namespace rayfarm
