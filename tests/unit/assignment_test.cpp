// The assignment's state machine, played through without a net: events and time in, actions out.
#include "host/farm/assignment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <map>
#include <set>

#include "protocol/job_plan.h"

namespace rayfarm {
namespace {

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

constexpr NodeId kNode1{1}, kNode2{2}, kNode3{3};

std::vector<NodeId> nodes_up_to(int last) {
  std::vector<NodeId> nodes;
  for (NodeId node(1); node.value() <= last; ++node) nodes.push_back(node);
  return nodes;
}

AssignmentOptions make_options(AssignmentPolicy policy, int nodes, int steps = 1) {
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

TEST(OnDemand, KeepsTwoAtEachNodeAndEndsWhole) {
  Player player(make_options(AssignmentPolicy::on_demand, 3));
  for (const NodeId node : nodes_up_to(3)) EXPECT_EQ(player.queues[node].size(), 2u);
  double now = 0;
  while (player.complete.empty()) {
    for (const NodeId node : nodes_up_to(3)) {
      player.step(node, now);
      EXPECT_LE(player.queues[node].size(), 2u);
    }
    now += 0.01;
    ASSERT_LT(now, 10);
  }
  EXPECT_TRUE(player.is_whole(1));
  EXPECT_EQ(player.duplicates, 0);
  player.machine.release(StepIndex(0), now);
  EXPECT_TRUE(player.machine.is_over());
}

TEST(OnDemand, ASlowNodeGetsLessAndItsLastIsGivenToAnother) {
  Player player(make_options(AssignmentPolicy::on_demand, 2));
  double now = 0;
  while (player.complete.empty()) {  // node 2 never answers, but is alive
    player.machine.hear(kNode2, now);
    player.step(kNode1, now);
    player.tick(now);
    now += 0.05;
    ASSERT_LT(now, 20);
  }
  EXPECT_TRUE(player.is_whole(1));
  EXPECT_TRUE(player.lost.empty());
  // What node 2 held was traced by node 1 as well; its late answer is a duplicate.
  player.step(kNode2, now);
  EXPECT_EQ(player.duplicates, 1);
}

TEST(OnDemand, ADeadNodesWorkGoesToTheOthers) {
  Player player(make_options(AssignmentPolicy::on_demand, 3));
  double now = 0;
  while (player.complete.empty()) {
    if (now < 0.5) player.step(kNode3, now);  // then it is dead
    player.step(kNode1, now);
    player.step(kNode2, now);
    player.machine.hear(kNode1, now);
    player.machine.hear(kNode2, now);
    player.tick(now);
    now += 0.5;
    ASSERT_LT(now, 60);
  }
  EXPECT_TRUE(player.is_whole(1));
  EXPECT_EQ(player.lost, std::vector<NodeId>{kNode3});
  EXPECT_EQ(player.machine.nodes_alive(), 2);
}

TEST(OnDemand, ALostNodeMayReturn) {
  Player player(make_options(AssignmentPolicy::on_demand, 2));
  player.machine.hear(kNode1, 20);
  player.tick(20);
  EXPECT_EQ(player.lost, std::vector<NodeId>{kNode2});
  player.machine.hear(kNode2, 21);
  player.read();
  EXPECT_EQ(player.returned, 1);
  double now = 21;
  while (player.complete.empty()) {
    player.step(kNode1, now);
    player.step(kNode2, now);
    now += 0.01;
    ASSERT_LT(now, 40);
  }
  EXPECT_TRUE(player.is_whole(1));
}

TEST(OnDemand, AllNodesLostIsToldWhenNoneReturns) {
  Player player(make_options(AssignmentPolicy::on_demand, 2));
  player.tick(100);
  EXPECT_EQ(player.machine.nodes_alive(), 0);
  EXPECT_FALSE(player.all_lost) << "they may only have been stopped";
  player.tick(100 + liveness::kAllSilent_s - 1);
  EXPECT_FALSE(player.all_lost);
  player.tick(100 + liveness::kAllSilent_s + 1);
  EXPECT_TRUE(player.all_lost);
}

TEST(OnDemand, OneOfAllSilentNodesReturnsAndDoesTheWork) {
  Player player(make_options(AssignmentPolicy::on_demand, 2));
  player.tick(100);
  player.machine.hear(kNode2, 110);
  player.read();
  double now = 110;
  while (player.complete.empty()) {
    player.step(kNode2, now);
    player.machine.hear(kNode2, now);
    player.tick(now);
    now += 0.01;
    ASSERT_LT(now, 130);
  }
  EXPECT_TRUE(player.is_whole(1));
  EXPECT_FALSE(player.all_lost);
}

TEST(OnDemand, AnExpelledNodeStaysOut) {
  Player player(make_options(AssignmentPolicy::on_demand, 2));
  const ItemIndex held = player.queues[kNode2].front();
  player.machine.expel(kNode2, 0);
  player.read();
  EXPECT_EQ(player.lost, std::vector<NodeId>{kNode2});
  player.queues[kNode2].clear();
  player.machine.hear(kNode2, 1);
  EXPECT_FALSE(player.machine.accept(kNode2, held, 1)) << "what it sends is not trusted";
  player.machine.fail(kNode2, held, "no", 1);
  player.read();
  EXPECT_EQ(player.returned, 0);
  EXPECT_EQ(player.machine.nodes_alive(), 1);
  double now = 1;
  while (player.complete.empty()) {
    player.machine.hear(kNode2, now);
    player.step(kNode1, now);
    player.tick(now);
    EXPECT_TRUE(player.queues[kNode2].empty());
    now += 0.01;
    ASSERT_LT(now, 20);
  }
  EXPECT_TRUE(player.is_whole(1));
}

TEST(OnDemand, WhenAllAreExpelledNobodyIsWaitedFor) {
  Player player(make_options(AssignmentPolicy::on_demand, 2));
  player.machine.expel(kNode1, 0);
  player.read();
  EXPECT_FALSE(player.all_lost);
  player.machine.expel(kNode2, 0);
  player.read();
  EXPECT_TRUE(player.all_lost);
}

TEST(OnDemand, ALostNodeThatFailsIsExpelled) {
  Player player(make_options(AssignmentPolicy::on_demand, 1));
  player.tick(100);
  EXPECT_FALSE(player.all_lost);
  player.machine.expel(kNode1, 101);  // its process is found to be gone
  player.read();
  EXPECT_TRUE(player.all_lost);
}

TEST(OnDemand, FortyNodesOfWhichMostAreLost) {
  // Node n falls silent at n/10 s, from 4 on; the work is done once and by the others.
  constexpr int kNodes = 40;
  AssignmentOptions options = make_options(AssignmentPolicy::on_demand, kNodes, 3);
  options.items_per_step = make_grid(0, 0, 256, 256, kNodes).count();
  Player player(options);
  double now = 0;
  size_t released = 0;
  while (!player.machine.is_over()) {
    for (const NodeId node : nodes_up_to(kNodes)) {
      if (node.value() > 4 && now > 0.1 * node.value()) continue;
      player.machine.hear(node, now);
      if (static_cast<int>(now * 20) % 5 == node.value() % 5) player.step(node, now);
    }
    player.tick(now);
    for (; released < player.complete.size(); ++released)
      player.machine.release(player.complete[released], now);
    player.read();
    now += 0.05;
    ASSERT_LT(now, 3000);
  }
  EXPECT_TRUE(player.is_whole(3));
  EXPECT_EQ(player.lost.size(), static_cast<size_t>(kNodes) - 4);
}

TEST(OnDemand, FailureIsTriedElsewhereAndThreeFailTheStep) {
  Player player(make_options(AssignmentPolicy::on_demand, 2, 2));
  const ItemIndex first = player.queues[kNode1].front();
  player.queues[kNode1].pop_front();
  player.machine.fail(kNode1, first, "boom", 0);
  player.read();
  EXPECT_TRUE(player.failed.empty());
  // Node 2 is full; the item comes to it next.
  player.step(kNode2, 0);
  const auto& queue = player.queues[kNode2];
  EXPECT_TRUE(std::find(queue.begin(), queue.end(), first) != queue.end());
  player.machine.fail(kNode2, first, "boom", 0);
  player.machine.fail(kNode1, first, "boom", 0);
  player.read();
  EXPECT_EQ(player.failed.at(StepIndex(0)), "boom");
  player.machine.release(StepIndex(0), 0);
  player.read();
  double now = 0;
  while (player.complete.empty()) {  // the next step is done all the same
    player.step(kNode1, now);
    player.step(kNode2, now);
    now += 0.01;
    ASSERT_LT(now, 10);
  }
  EXPECT_EQ(player.complete, std::vector<StepIndex>{StepIndex(1)});
}

TEST(OnDemand, TheWindowBoundsTheStepsBegun) {
  AssignmentOptions options = make_options(AssignmentPolicy::on_demand, 2, 10);
  options.window_steps = 2;
  Player player(options);
  double now = 0;
  std::set<StepIndex> seen;
  for (int i = 0; i < 1000; ++i, now += 0.01) {
    for (const NodeId node : nodes_up_to(2)) {
      for (const ItemIndex item : player.queues[node]) seen.insert(player.step_of(item));
      player.step(node, now);
    }
  }
  EXPECT_EQ(seen, (std::set{StepIndex(0), StepIndex(1)}))
      << "nothing was released, so no third step may begin";
  player.machine.release(StepIndex(0), now);
  player.read();
  EXPECT_FALSE(player.queues[kNode1].empty());
  EXPECT_EQ(player.step_of(player.queues[kNode1].front()), StepIndex(2));
}

/// Plays nodes that do their own items; `alive(node, now)` says which do.
template <typename Alive>
void play_interleaved(Player& player, int nodes, int steps, Alive alive) {
  std::map<NodeId, std::deque<ItemIndex>> own;
  std::map<NodeId, StepIndex> next_step;
  double now = 0;
  size_t released = 0;
  while (released < static_cast<size_t>(steps)) {
    for (const NodeId node : nodes_up_to(nodes)) {
      if (!alive(node, now)) continue;
      player.machine.hear(node, now);
      player.read();
      if (player.step(node, now)) continue;
      if (own[node].empty() && next_step[node] < player.open_end) {
        const int64_t first = int64_t{next_step[node].value()} * player.options.items_per_step;
        for (ItemIndex item(first); item.value() < first + player.options.items_per_step; ++item)
          if (player.options.owner_of(item) == node) own[node].push_back(item);
        ++next_step[node];
      }
      if (own[node].empty()) continue;
      const ItemIndex item = own[node].front();
      own[node].pop_front();
      player.done(node, item, now);
    }
    player.tick(now);
    for (; released < player.complete.size(); ++released)
      player.machine.release(player.complete[released], now);
    player.read();
    now += 0.1;
    ASSERT_LT(now, 300);
  }
}

TEST(Interleaved, NeedsNoAssignments) {
  Player player(make_options(AssignmentPolicy::interleaved, 3, 5));
  play_interleaved(player, 3, 5, [](NodeId, double) { return true; });
  EXPECT_TRUE(player.is_whole(5));
  EXPECT_TRUE(player.queues[kNode1].empty() && player.queues[kNode2].empty() &&
              player.queues[kNode3].empty());
  EXPECT_TRUE(player.machine.is_over());
}

TEST(Interleaved, WhatALostNodeLeavesIsHandedOut) {
  Player player(make_options(AssignmentPolicy::interleaved, 3, 5));
  play_interleaved(player, 3, 5, [](NodeId node, double now) { return node != kNode2 || now < 0.5; });
  EXPECT_TRUE(player.is_whole(5));
  EXPECT_EQ(player.lost, std::vector<NodeId>{kNode2});
}

TEST(Interleaved, ANodeThatComesBackDoesNoHarm) {
  Player player(make_options(AssignmentPolicy::interleaved, 3, 8));
  play_interleaved(player, 3, 8,
                   [](NodeId node, double now) { return node != kNode2 || now < 0.5 || now > 14; });
  EXPECT_TRUE(player.is_whole(8));
}

TEST(Assignment, NonsenseIsIgnored) {
  Player player(make_options(AssignmentPolicy::on_demand, 2));
  EXPECT_FALSE(player.machine.accept(kNode1, ItemIndex(7 * player.options.items_per_step), 0));
  EXPECT_FALSE(player.machine.accept(kNode1, ItemIndex(-1), 0));
  EXPECT_FALSE(player.machine.accept(kNode1, ItemIndex(100000), 0));
  player.machine.fail(kNode1, ItemIndex(-1), "", 0);
}

// Phases follow each other; what is known of nodes stays.
TEST(Phases, NodesStayWhatTheyWere) {
  for (const auto policy : {AssignmentPolicy::on_demand, AssignmentPolicy::interleaved}) {
    Player player(make_options(policy, 3));
    const auto finish = [&](double now) {
      for (ItemIndex item; item.value() < player.options.items_per_step; ++item)
        player.machine.accept(kNode1, item, now);
      player.machine.release(StepIndex(0), now);
      player.read();
      EXPECT_TRUE(player.machine.is_over());
      player.queues.clear();
    };
    player.machine.expel(kNode2, 0.1);
    for (const double now : {5.0, 9.0}) {
      player.machine.hear(kNode1, now);
      player.tick(now);
    }
    EXPECT_EQ(player.lost, (std::vector{kNode2, kNode3}));
    finish(9.0);
    PhaseWork next;
    next.items_per_step = player.options.items_per_step = 7;
    if (policy == AssignmentPolicy::interleaved)
      next.owner_of = [](ItemIndex item) { return NodeId(static_cast<int>(item.value() % 3) + 1); };
    player.machine.begin(next, 9.1);
    player.read();
    EXPECT_FALSE(player.machine.is_over());
    EXPECT_TRUE(player.queues[kNode2].empty() && player.queues[kNode3].empty());
    // What node 1 does not do by itself is handed out to it.
    EXPECT_EQ(player.queues[kNode1].size(), 2u);
    EXPECT_FALSE(player.machine.accept(kNode2, ItemIndex(0), 9.2)) << "expelled";
    EXPECT_FALSE(player.machine.needs(kNode2, ItemIndex(0)));
    EXPECT_FALSE(player.machine.accept(kNode1, ItemIndex(7), 9.2)) << "the phase before had more items";
    EXPECT_EQ(player.returned, 0);
    EXPECT_TRUE(player.machine.needs(kNode3, ItemIndex(6)));
    EXPECT_TRUE(player.machine.accept(kNode3, ItemIndex(6), 9.2)) << "it is heard again";
    player.read();
    EXPECT_EQ(player.returned, 1);
    EXPECT_FALSE(player.queues[kNode3].empty());
    finish(9.3);
  }
}

}  // namespace
}  // namespace rayfarm
