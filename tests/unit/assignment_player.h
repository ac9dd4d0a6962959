#pragma once
// Plays what nodes do to an assignment, without a net.
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <map>
#include <set>

#include "host/farm/assignment.h"
#include "protocol/job_plan.h"

namespace rayfarm::test {

struct Player {
  explicit Player(AssignmentOptions o) : options(std::move(o)), machine(options, 0) { read(); }

  void read() {
    for (const Action& action : machine.take_actions()) {
      if (const auto* a = std::get_if<AssignItem>(&action)) queues[a->node].push_back(a->item);
      if (const auto* s = std::get_if<StepComplete>(&action)) complete.push_back(s->step);
      if (const auto* s = std::get_if<StepFailed>(&action)) failed[s->step] = s->problem;
      if (const auto* l = std::get_if<NodeLost>(&action)) lost.push_back(l->node);
      if (const auto* o = std::get_if<OpenedSteps>(&action)) open_end = o->end;
      if (std::holds_alternative<NodeReturned>(action)) ++returned;
      if (std::holds_alternative<AllNodesLost>(action)) all_lost = true;
    }
  }
  /// A node returns the first item it holds; false if it holds none.
  bool step(NodeId node, double now) {
    if (queues[node].empty()) return false;
    const ItemIndex item = queues[node].front();
    queues[node].pop_front();
    done(node, item, now);
    return true;
  }
  void done(NodeId node, ItemIndex item, double now) {
    if (machine.accept(node, item, now)) {
      EXPECT_TRUE(kept.insert(item).second);
    } else {
      ++duplicates;
    }
    read();
  }
  void tick(double now) {
    machine.tick(now);
    read();
  }
  bool is_whole(int steps) const {
    return kept.size() == static_cast<size_t>(steps) * static_cast<size_t>(options.items_per_step);
  }
  StepIndex step_of(ItemIndex item) const {
    return StepIndex(static_cast<int>(item.value() / options.items_per_step));
  }

  AssignmentOptions options;
  std::map<NodeId, std::deque<ItemIndex>> queues;
  std::vector<StepIndex> complete;
  std::vector<NodeId> lost;
  std::map<StepIndex, std::string> failed;
  std::set<ItemIndex> kept;
  int duplicates = 0, returned = 0;
  StepIndex open_end;
  bool all_lost = false;
  Assignment machine;
};

inline constexpr NodeId kNode1{1}, kNode2{2}, kNode3{3};

inline std::vector<NodeId> nodes_up_to(int last) {
  std::vector<NodeId> nodes;
  for (NodeId node(1); node.value() <= last; ++node) nodes.push_back(node);
  return nodes;
}

inline AssignmentOptions make_options(AssignmentPolicy policy, int nodes, int steps = 1) {
  // The frames of a sequence, each of 8 × 8 subpolygons.
  const auto plan = std::make_shared<JobPlan>();
  PicturesPhase pictures{
      std::vector<FrameNumber>(static_cast<size_t>(steps)), make_grid(0, 0, 64, 64, nodes), {}};
  plan->processors = nodes;
  plan->pictures = pictures;
  AssignmentOptions o;
  o.nodes = nodes;
  o.steps = steps;
  o.items_per_step = pictures.items_per_step();
  if (policy == AssignmentPolicy::interleaved)
    o.owner_of = [plan](ItemIndex item) { return owner_of(*plan, plan->pictures, item); };
  return o;
}

}  // namespace rayfarm::test
