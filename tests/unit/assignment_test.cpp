// The assignment's state machine, played through without a net: events and time in, actions out.
#include <malloc.h>

#include "tests/unit/assignment_player.h"

namespace rayfarm {
namespace {

using namespace test;

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

TEST(OnDemand, NothingIsHandedOutBeforeItIsAllowed) {
  AssignmentOptions options = make_options(AssignmentPolicy::on_demand, 2);
  options.allowed_end = ItemIndex(3);
  Player player(options);
  const auto play = [&] {
    for (bool goes_on = true; goes_on;) {
      goes_on = player.step(kNode2, 1);
      goes_on |= player.step(kNode1, 1);
    }
    player.tick(1);
    return player.kept.size();
  };
  EXPECT_EQ(play(), 3u);
  player.machine.allow_before(ItemIndex(2), 1);  // it never goes back
  EXPECT_EQ(play(), 3u);
  player.machine.allow_before(ItemIndex(5), 1);
  player.read();
  // What was handed out and comes back may be handed out again.
  player.machine.expel(kNode2, 1);
  player.queues.erase(kNode2);
  player.read();
  EXPECT_EQ(play(), 5u);
  player.machine.allow_before(ItemIndex(player.options.items_per_step), 1);
  player.read();
  play();
  EXPECT_TRUE(player.is_whole(1));
  EXPECT_EQ(player.complete.size(), 1u);
}

TEST(OnDemand, WhatIsReleasedTakesNoMemory) {
  AssignmentOptions options;
  options.nodes = 2;
  options.steps = 200;
  options.items_per_step = 10'000;
  options.window_steps = 1;
  const size_t before = mallinfo2().uordblks;
  Player player(options);
  for (StepIndex step; step.value() < options.steps; ++step) {
    while (player.step(kNode1, 1) || player.step(kNode2, 1)) {
    }
    ASSERT_EQ(player.complete.size(), step.place() + 1);
    player.kept.clear();
    player.machine.release(step, 1);
    player.read();
  }
  EXPECT_TRUE(player.machine.is_over());
  EXPECT_LT(mallinfo2().uordblks, before + (8 << 20));  // of 48 MB
}

TEST(OnDemand, NothingIsHandedOutOfAnAbandonedStep) {
  Player player(make_options(AssignmentPolicy::on_demand, 2, 2));
  // A result comes, and in the same turn the step is abandoned: what was to follow is not handed out.
  player.machine.accept(kNode1, player.queues[kNode1].front(), 1);
  player.machine.abandon(StepIndex(0), 1);
  for (const Action& action : player.machine.take_actions())
    if (const auto* assign = std::get_if<AssignItem>(&action)) {
      EXPECT_EQ(player.step_of(assign->item), StepIndex(1));
    }
}

TEST(OnDemand, AnAbandonedStepIsOver) {
  Player player(make_options(AssignmentPolicy::on_demand, 2, 2));
  player.step(kNode1, 1);
  player.machine.abandon(StepIndex(0), 1);
  player.machine.abandon(StepIndex(0), 1);
  player.read();
  // What the nodes still do of it is dropped, and they go on with the next.
  while (player.step(kNode1, 1) || player.step(kNode2, 1)) {
  }
  EXPECT_EQ(player.complete, std::vector<StepIndex>{StepIndex(1)});
  EXPECT_TRUE(player.failed.empty());
  EXPECT_FALSE(player.machine.is_over());
  player.machine.release(StepIndex(0), 1);
  player.machine.release(StepIndex(1), 1);
  EXPECT_TRUE(player.machine.is_over());
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

}  // namespace
}  // namespace rayfarm
