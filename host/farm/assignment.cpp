#include "host/farm/assignment.h"

#include <algorithm>
#include <tuple>

namespace rayfarm {

Assignment::Assignment(const AssignmentOptions& options, double now)
    : options_(options), nodes_(static_cast<size_t>(options.nodes)) {
  for (NodeState& node : nodes_) node.heard = now;
  begin(options, now);
}

void Assignment::begin(const PhaseWork& work, double now) {
  static_cast<PhaseWork&>(options_) = work;
  steps_ = std::vector<Step>(static_cast<size_t>(work.steps));
  waiting_.clear();
  opened_ = StepIndex();
  released_ = 0;
  for (NodeId node(1); node.value() <= options_.nodes; ++node) {
    NodeState& state = node_state(node);
    state.freed = now;
    state.assigned.clear();
    state.own.clear();
    state.own_left = 0;
    update_room(node);
  }
  open_steps(now);
  hand_out(now);
}

int Assignment::Item::holder_count() const {
  return static_cast<int>(
      std::count_if(holders.begin(), holders.end(), [](NodeId n) { return n != NodeId(); }));
}

bool Assignment::Item::is_held_by(NodeId node) const {
  return std::find(holders.begin(), holders.end(), node) != holders.end();
}

void Assignment::Item::add_holder(NodeId node) {
  NodeId& place = holders[0] == NodeId() ? holders[0] : holders[1];
  place = node;
}

bool Assignment::Item::drop_holder(NodeId node) {
  const auto place = std::find(holders.begin(), holders.end(), node);
  if (place == holders.end()) return false;
  *place = NodeId();
  return true;
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
        item.add_holder(owner);
        node_state(owner).own.push_back(index);
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

/// A node works through what it holds: it has had the first of it in hand since it last returned something.
std::vector<NodeId> Assignment::nodes_that_are_slow(double now) const {
  std::vector<NodeId> slow;
  for (NodeId node(1); node.value() <= options_.nodes; ++node) {
    const NodeState& state = nodes_[node.place() - 1];
    const bool has_work = !state.assigned.empty() || state.own_left > 0;
    if (!state.is_lost && has_work && now - state.freed >= options_.duplicate_after_s) slow.push_back(node);
  }
  return slow;
}

bool Assignment::is_done(ItemIndex item) {
  return at(step_of(item)).is_over || at(item).state == State::done;
}

bool Assignment::is_held_alone(ItemIndex item, NodeId by) {
  return !is_done(item) && at(item).holder_count() == 1 && at(item).is_held_by(by);
}

std::optional<ItemIndex> Assignment::oldest_held_by(std::span<const NodeId> others, NodeId node, double now) {
  std::optional<ItemIndex> best;
  const auto consider = [&](ItemIndex item) {
    // Earlier steps first: they hold the window.
    const auto key = [this](ItemIndex i) { return std::tuple(step_of(i), at(i).since, i); };
    if (!best || key(item) < key(*best)) best = item;
  };
  for (const NodeId other : others) {
    if (other == node) continue;
    NodeState& state = node_state(other);
    const auto is_old = [&](ItemIndex i) { return now - at(i).since >= options_.duplicate_after_s; };
    for (const ItemIndex item : state.assigned)
      if (is_held_alone(item, other) && is_old(item)) consider(item);
    while (!state.own.empty() && is_done(state.own.front())) state.own.pop_front();
    const auto first = std::find_if(state.own.begin(), state.own.end(),
                                    [&](ItemIndex item) { return is_held_alone(item, other); });
    if (first != state.own.end() && is_old(*first)) consider(*first);
  }
  return best;
}

void Assignment::give(NodeId node, ItemIndex index, double now) {
  Item& item = at(index);
  item.state = State::held;
  item.since = now;
  item.add_holder(node);
  node_state(node).assigned.push_back(index);
  update_room(node);
  actions_.emplace_back(AssignItem{node, index});
}

void Assignment::update_room(NodeId node) {
  for (int n = 0; n < options_.held_per_node; ++n) with_room_.erase({static_cast<size_t>(n), node});
  const NodeState& state = node_state(node);
  if (!state.is_lost && static_cast<int>(state.assigned.size()) < options_.held_per_node)
    with_room_.insert({state.assigned.size(), node});
}

void Assignment::hand_out(double now) {
  // Round by round, so that every node has one before any has two.
  for (auto place = with_room_.begin(); place != with_room_.end();) {
    const auto [count, node] = *place;
    auto item = next_waiting();
    if (item && at(*item).failed_at == node && nodes_alive() > 1) {
      // What failed at a node goes to another, if there is one: this node takes the next.
      const ItemIndex failed = *item;
      item = next_waiting();
      waiting_.push_front(failed);
      if (!item) {
        ++place;
        continue;
      }
    }
    if (!item) return;
    give(node, *item, now);
    place = with_room_.upper_bound({count, node});
  }
}

void Assignment::help(NodeId node, std::span<const NodeId> slow, double now) {
  if (!node_state(node).is_idle()) return;
  if (const auto item = oldest_held_by(slow, node, now)) give(node, *item, now);
}

void Assignment::help_if_idle(NodeId node, double now) {
  if (node_state(node).is_idle()) help(node, nodes_that_are_slow(now), now);
}

void Assignment::hear(NodeId node, double now) {
  NodeState& state = node_state(node);
  if (state.is_expelled) return;
  state.heard = now;
  if (!state.is_lost) return;
  state.is_lost = false;
  state.freed = now;
  update_room(node);
  actions_.emplace_back(NodeReturned{node});
  hand_out(now);
  help_if_idle(node, now);
}

void Assignment::finish_item(ItemIndex index) {
  Item& item = at(index);
  for (const NodeId holder : item.holders) {
    if (holder != NodeId() && is_own(holder, index) && !node_state(holder).is_lost)
      --node_state(holder).own_left;
  }
  item.holders = {};
  item.state = State::done;
}

bool Assignment::is_credible(NodeId node, ItemIndex item) {
  return item >= ItemIndex(0) && item < first_of(opened_) && !node_state(node).is_expelled;
}

bool Assignment::needs(NodeId node, ItemIndex item) {
  return is_credible(node, item) && !is_done(item);
}

bool Assignment::accept(NodeId node, ItemIndex item, double now) {
  if (!is_credible(node, item)) return false;
  hear(node, now);
  NodeState& state = node_state(node);
  state.freed = now;
  std::erase(state.assigned, item);
  update_room(node);
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
  help_if_idle(node, now);
  return is_news;
}

void Assignment::fail(NodeId node, ItemIndex index, const std::string& problem, double now) {
  if (!is_credible(node, index)) return;
  hear(node, now);
  std::erase(node_state(node).assigned, index);
  update_room(node);
  Step& step = at(step_of(index));
  if (!step.is_over && at(index).state != State::done) {
    Item& item = at(index);
    if (++item.tries >= options_.most_tries) {
      step.is_over = true;
      const StepIndex failed = step_of(index);
      for (ItemIndex i = first_of(failed); i < first_of(StepIndex(failed.value() + 1)); ++i) finish_item(i);
      actions_.emplace_back(StepFailed{failed, problem});
    } else {
      if (item.drop_holder(node) && is_own(node, index)) --node_state(node).own_left;
      item.failed_at = node;
      if (item.holder_count() == 0) {
        item.state = State::waiting;
        waiting_.push_front(index);
      }
    }
  }
  hand_out(now);
  help_if_idle(node, now);
}

void Assignment::mark_lost(NodeId node, double now) {
  NodeState& state = node_state(node);
  if (state.is_lost) return;
  state.is_lost = true;
  actions_.emplace_back(NodeLost{node, !state.assigned.empty() || state.own_left > 0, state.is_expelled});
  state.own_left = 0;
  state.own.clear();
  state.assigned.clear();
  update_room(node);
  std::deque<ItemIndex> orphans;
  for (StepIndex s; s < opened_; ++s) {
    if (at(s).is_over) continue;
    ItemIndex index = first_of(s);
    for (Item& item : at(s).items) {
      const bool was_its = item.state == State::held && item.drop_holder(node);
      if (was_its && item.holder_count() == 0) {  // else another has it too
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
  const std::vector<NodeId> slow = nodes_that_are_slow(now);
  if (slow.empty()) return;
  for (NodeId node(1); node.value() <= options_.nodes; ++node) help(node, slow, now);
}

}  // namespace rayfarm
