#include "host/farm/assignment.h"

#include <algorithm>

namespace rayfarm {

Assignment::Assignment(const AssignmentOptions& options, double now)
    : options_(options),
      nodes_(static_cast<size_t>(options.nodes)),
      with_room_(static_cast<size_t>(options.held_per_node), NodeSet(options.nodes)),
      idle_(options.nodes),
      alive_(options.nodes) {
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
    state.helped.clear();
    state.own_left = 0;
    state.is_watched = false;
    update_room(node);
  }
  watched_ = {};
  slow_.clear();
  open_steps(now);
  hand_out(now);
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
      if (options_.is_done && options_.is_done(index)) {
        item.state = State::done;
        --step.left;
        ++index;
        continue;
      }
      const NodeId owner = options_.owner_of ? options_.owner_of(index) : NodeId();
      if (options_.owner_of && !node_state(owner).is_lost) {
        item.state = State::held;
        item.add_holder(owner);
        node_state(owner).own.push_back(index);
        if (++node_state(owner).own_left == 1) update_room(owner);
        watch(owner);
      } else {
        item.state = State::waiting;
        waiting_.push_back(index);
      }
      ++index;
    }
    if (step.left == 0) {
      step.is_over = true;
      actions_.emplace_back(StepComplete{opened_});
    }
    ++opened_;
  }
  if (opened_ != before && options_.owner_of) actions_.emplace_back(OpenedSteps{opened_});
}

std::optional<ItemIndex> Assignment::next_waiting() {
  while (!waiting_.empty()) {
    const ItemIndex item = waiting_.front();
    if (item >= options_.allowed_end) break;  // what was handed out before and waits again stands before it
    waiting_.pop_front();
    if (!at(step_of(item)).is_over && at(item).state == State::waiting) return item;
  }
  return std::nullopt;
}

bool Assignment::is_done(ItemIndex item) {
  return at(step_of(item)).is_over || at(item).state == State::done;
}

bool Assignment::is_held_alone(ItemIndex item, NodeId by) {
  return !is_done(item) && at(item).holder_count() == 1 && at(item).is_held_by(by);
}

/// A node works through what it holds: it has had the first of it in hand since it last returned something,
/// or since it was given that. Never, if it holds nothing that nobody helps with.
double Assignment::slow_from(NodeId node) {
  NodeState& state = node_state(node);
  if (state.is_lost) return kNever;
  double since = kNever;
  for (const ItemIndex item : state.assigned)
    if (is_held_alone(item, node)) since = std::min(since, at(item).since);
  while (!state.own.empty() && is_done(state.own.front())) state.own.pop_front();
  if (!state.own.empty()) since = std::min(since, at(state.own.front()).since);
  return std::max(since, state.freed) + options_.duplicate_after_s;
}

void Assignment::watch(NodeId node) {
  NodeState& state = node_state(node);
  if (state.is_watched) return;
  const double from = slow_from(node);
  if (from == kNever) return;
  state.is_watched = true;
  watched_.emplace(from, node);
}

std::optional<Assignment::Help> Assignment::help_for(NodeId node, double now) {
  if (slow_from(node) > now) return std::nullopt;
  const NodeState& state = node_state(node);
  std::optional<Help> best;
  const auto consider = [&](ItemIndex item) {
    if (now - at(item).since < options_.duplicate_after_s) return;
    const Help help{step_of(item), at(item).since, item, node};
    if (!best || help < *best) best = help;
  };
  for (const ItemIndex item : state.assigned)
    if (is_held_alone(item, node)) consider(item);
  if (!state.own.empty()) consider(state.own.front());
  return best;
}

std::optional<ItemIndex> Assignment::next_to_help(double now) {
  const auto judge = [&](NodeId node) {
    node_state(node).is_watched = false;
    if (const std::optional<Help> help = help_for(node, now)) {
      node_state(node).is_watched = true;
      slow_.insert(*help);
    } else {
      watch(node);
    }
  };
  while (!watched_.empty() && watched_.top().first <= now) {
    const NodeId node = watched_.top().second;
    watched_.pop();
    judge(node);
  }
  while (!slow_.empty()) {
    const Help first = *slow_.begin();
    const NodeId node = std::get<NodeId>(first);
    if (help_for(node, now) == first) return std::get<ItemIndex>(first);
    slow_.erase(slow_.begin());
    judge(node);
  }
  return std::nullopt;
}

void Assignment::give(NodeId node, ItemIndex index, double now) {
  Item& item = at(index);
  item.state = State::held;
  item.since = now;
  item.add_holder(node);
  node_state(node).assigned.push_back(index);
  if (is_own(node, index)) ++node_state(node).own_left;  // it is so again: it was lost, or failed
  update_room(node);
  watch(node);
  actions_.emplace_back(AssignItem{node, index});
}

void Assignment::update_room(NodeId node) {
  const NodeState& state = node_state(node);
  for (size_t n = 0; n < with_room_.size(); ++n) {
    if (!state.is_lost && state.assigned.size() == n)
      with_room_[n].insert(node);
    else
      with_room_[n].erase(node);
  }
  if (!state.is_lost && !state.has_work())
    idle_.insert(node);
  else
    idle_.erase(node);
}

void Assignment::hand_out(double now) {
  // Round by round, so that every node has one before any has two.
  for (const NodeSet& round : with_room_) {
    for (auto node = round.first_from(); node; node = round.first_from(NodeId(node->value() + 1))) {
      auto item = next_waiting();
      if (item && at(*item).failed_at == *node && alive_ > 1) {
        // What failed at a node goes to another, if there is one: this node takes the next.
        const ItemIndex failed = *item;
        item = next_waiting();
        waiting_.push_front(failed);
        if (!item) continue;
      }
      if (!item) return;
      give(*node, *item, now);
    }
  }
}

void Assignment::help_if_idle(NodeId node, double now) {
  const NodeState& state = node_state(node);
  if (state.is_lost || state.has_work()) return;
  const auto item = next_to_help(now);
  if (!item) return;
  NodeState& slow =
      node_state(at(*item).holders[0] != NodeId() ? at(*item).holders[0] : at(*item).holders[1]);
  if (!slow.own.empty() && slow.own.front() == *item) {
    slow.own.pop_front();
    slow.helped.push_back(*item);
  }
  give(node, *item, now);
}

void Assignment::hear(NodeId node, double now) {
  NodeState& state = node_state(node);
  if (state.is_expelled) return;
  state.heard = now;
  if (!state.is_lost) return;
  state.is_lost = false;
  ++alive_;
  state.freed = now;
  update_room(node);
  actions_.emplace_back(NodeReturned{node});
  hand_out(now);
  help_if_idle(node, now);
}

void Assignment::finish_item(ItemIndex index) {
  Item& item = at(index);
  for (const NodeId holder : item.holders) {
    if (holder == NodeId() || !is_own(holder, index) || node_state(holder).is_lost) continue;
    std::erase(node_state(holder).helped, index);
    if (--node_state(holder).own_left == 0) update_room(holder);
  }
  item.holders = {};
  item.state = State::done;
}

/// Whatever of it is not done.
void Assignment::end_step(StepIndex step) {
  at(step).is_over = true;
  // What was about to be handed out of it is not any more.
  std::erase_if(actions_, [&](const Action& action) {
    const auto* assign = std::get_if<AssignItem>(&action);
    if (!assign || step_of(assign->item) != step) return false;
    std::erase(node_state(assign->node).assigned, assign->item);
    update_room(assign->node);
    return true;
  });
  for (ItemIndex i = first_of(step); i < first_of(StepIndex(step.value() + 1)); ++i) finish_item(i);
}

/// A node does not do an item any more; who else does does it alone, or another is to do it.
void Assignment::leave(ItemIndex index, NodeId node) {
  Item& item = at(index);
  if (!item.drop_holder(node)) return;
  if (item.holder_count() == 0) {
    item.state = State::waiting;
    return;
  }
  const NodeId other = item.holders[0] != NodeId() ? item.holders[0] : item.holders[1];
  NodeState& state = node_state(other);
  if (std::erase(state.helped, index) > 0)
    state.own.insert(std::lower_bound(state.own.begin(), state.own.end(), index), index);
  watch(other);
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
      end_step(step_of(index));
      actions_.emplace_back(StepFailed{step_of(index), problem});
    } else {
      if (NodeState& state = node_state(node); item.is_held_by(node) && is_own(node, index)) {
        --state.own_left;
        std::erase(state.own, index);
        std::erase(state.helped, index);
        update_room(node);
      }
      item.failed_at = node;
      leave(index, node);
      if (item.state == State::waiting) waiting_.push_front(index);
    }
  }
  hand_out(now);
  help_if_idle(node, now);
}

void Assignment::mark_lost(NodeId node, double now) {
  NodeState& state = node_state(node);
  if (state.is_lost) return;
  state.is_lost = true;
  --alive_;
  actions_.emplace_back(NodeLost{node, state.has_work(), state.is_expelled});
  std::vector<ItemIndex> held(std::move(state.assigned));
  held.insert(held.end(), state.own.begin(), state.own.end());
  held.insert(held.end(), state.helped.begin(), state.helped.end());
  std::sort(held.begin(), held.end());
  state.own_left = 0;
  state.own.clear();
  state.helped.clear();
  state.assigned.clear();
  update_room(node);
  std::erase_if(held, [&](ItemIndex item) {
    if (is_done(item)) return true;
    leave(item, node);
    return at(item).state != State::waiting;  // another has it too
  });
  waiting_.insert(waiting_.begin(), held.begin(), held.end());
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

void Assignment::allow_before(ItemIndex end, double now) {
  if (end <= options_.allowed_end) return;
  options_.allowed_end = end;
  hand_out(now);
}

void Assignment::abandon(StepIndex step, double now) {
  if (step >= opened_ || at(step).is_over) return;
  end_step(step);
  hand_out(now);
}

void Assignment::release(StepIndex index, double now) {
  Step& step = at(index);
  if (step.is_released) return;
  step.is_released = true;
  step.items = std::vector<Item>();  // `{}` would keep the memory
  ++released_;
  open_steps(now);
  hand_out(now);
}

void Assignment::tick(double now) {
  for (NodeId node(1); node.value() <= options_.nodes; ++node)
    if (now - node_state(node).heard > options_.lost_after_s) mark_lost(node, now);
  give_up_without_nodes(now);
  hand_out(now);
  // Until nothing is left to help with, or nobody to help.
  for (auto node = idle_.first_from(); node; node = idle_.first_from(NodeId(node->value() + 1))) {
    help_if_idle(*node, now);
    if (!node_state(*node).has_work()) return;
  }
}

}  // namespace rayfarm
