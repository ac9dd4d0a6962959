// The assignment's state machine, played through without a net: events and time in, actions out.
#include "host/farm/assignment.h"

#include <gtest/gtest.h>

#include <deque>
#include <map>
#include <set>

namespace rayfarm {
namespace {

struct Player {
  explicit Player(AssignmentOptions o) : options(std::move(o)), machine(options, 0) { read(); }

  void read() {
    for (const Action& action : machine.take_actions()) {
      if (const auto* a = std::get_if<AssignSubpolygon>(&action)) queues[a->node].push_back(*a);
      if (const auto* f = std::get_if<FrameComplete>(&action)) complete.push_back(f->frame);
      if (const auto* f = std::get_if<FrameFailed>(&action)) failed[f->frame] = f->problem;
      if (const auto* l = std::get_if<NodeLost>(&action)) lost.push_back(l->node);
      if (const auto* o = std::get_if<OpenFrames>(&action)) window_end = o->end;
      if (std::holds_alternative<NodeReturned>(action)) ++returned;
      if (std::holds_alternative<AllNodesLost>(action)) all_lost = true;
    }
  }
  /// A node returns the first subpolygon it holds; false if it holds none.
  bool step(int node, double now) {
    if (queues[node].empty()) return false;
    const AssignSubpolygon work = queues[node].front();
    queues[node].pop_front();
    done(node, work.frame, work.subpolygon, now);
    return true;
  }
  void done(int node, int frame, int subpolygon, double now) {
    if (machine.accept(node, frame, subpolygon, now)) {
      EXPECT_TRUE(kept.insert({frame, subpolygon}).second);
    } else {
      ++duplicates;
    }
    read();
  }
  void tick(double now) {
    machine.tick(now);
    read();
  }
  bool is_whole(int frames) const {
    return kept.size() == static_cast<size_t>(frames * options.grid.count());
  }

  AssignmentOptions options;
  std::map<int, std::deque<AssignSubpolygon>> queues;
  std::vector<int> complete, lost;
  std::map<int, std::string> failed;
  std::set<std::pair<int, int>> kept;
  int duplicates = 0, window_end = 0, returned = 0;
  bool all_lost = false;
  Assignment machine;
};

AssignmentOptions make_options(AssignmentPolicy policy, int nodes, int frames = 1) {
  AssignmentOptions o;
  o.policy = policy;
  o.nodes = nodes;
  o.frames = frames;
  o.grid = make_grid(0, 0, 64, 64, nodes);  // 8 × 8 subpolygons
  return o;
}

TEST(OnDemand, KeepsTwoAtEachNodeAndEndsWhole) {
  Player player(make_options(AssignmentPolicy::on_demand, 3));
  for (int node = 1; node <= 3; ++node) EXPECT_EQ(player.queues[node].size(), 2u);
  double now = 0;
  while (player.complete.empty()) {
    for (int node = 1; node <= 3; ++node) {
      player.step(node, now);
      EXPECT_LE(player.queues[node].size(), 2u);
    }
    now += 0.01;
    ASSERT_LT(now, 10);
  }
  EXPECT_TRUE(player.is_whole(1));
  EXPECT_EQ(player.duplicates, 0);
  player.machine.release(0, now);
  EXPECT_TRUE(player.machine.is_over());
}

TEST(OnDemand, ASlowNodeGetsLessAndItsLastIsGivenToAnother) {
  Player player(make_options(AssignmentPolicy::on_demand, 2));
  double now = 0;
  while (player.complete.empty()) {  // node 2 never answers, but is alive
    player.machine.hear(2, now);
    player.step(1, now);
    player.tick(now);
    now += 0.05;
    ASSERT_LT(now, 20);
  }
  EXPECT_TRUE(player.is_whole(1));
  EXPECT_TRUE(player.lost.empty());
  // What node 2 held was traced by node 1 as well; its late answer is a duplicate.
  player.step(2, now);
  EXPECT_EQ(player.duplicates, 1);
}

TEST(OnDemand, ADeadNodesWorkGoesToTheOthers) {
  Player player(make_options(AssignmentPolicy::on_demand, 3));
  double now = 0;
  while (player.complete.empty()) {
    if (now < 0.5) player.step(3, now);  // then it is dead
    player.step(1, now);
    player.step(2, now);
    player.machine.hear(1, now);
    player.machine.hear(2, now);
    player.tick(now);
    now += 0.5;
    ASSERT_LT(now, 60);
  }
  EXPECT_TRUE(player.is_whole(1));
  EXPECT_EQ(player.lost, std::vector<int>{3});
  EXPECT_EQ(player.machine.nodes_alive(), 2);
}

TEST(OnDemand, ALostNodeMayReturn) {
  Player player(make_options(AssignmentPolicy::on_demand, 2));
  player.machine.hear(1, 20);
  player.tick(20);
  EXPECT_EQ(player.lost, std::vector<int>{2});
  player.machine.hear(2, 21);
  player.read();
  EXPECT_EQ(player.returned, 1);
  double now = 21;
  while (player.complete.empty()) {
    player.step(1, now);
    player.step(2, now);
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
  player.machine.hear(2, 110);
  player.read();
  double now = 110;
  while (player.complete.empty()) {
    player.step(2, now);
    player.machine.hear(2, now);
    player.tick(now);
    now += 0.01;
    ASSERT_LT(now, 130);
  }
  EXPECT_TRUE(player.is_whole(1));
  EXPECT_FALSE(player.all_lost);
}

TEST(OnDemand, AnExpelledNodeStaysOut) {
  Player player(make_options(AssignmentPolicy::on_demand, 2));
  const AssignSubpolygon held = player.queues[2].front();
  player.machine.expel(2, 0);
  player.read();
  EXPECT_EQ(player.lost, std::vector<int>{2});
  player.queues[2].clear();
  player.machine.hear(2, 1);
  EXPECT_FALSE(player.machine.accept(2, held.frame, held.subpolygon, 1)) << "what it sends is not trusted";
  player.machine.fail(2, held.frame, held.subpolygon, "no", 1);
  player.read();
  EXPECT_EQ(player.returned, 0);
  EXPECT_EQ(player.machine.nodes_alive(), 1);
  double now = 1;
  while (player.complete.empty()) {
    player.machine.hear(2, now);
    player.step(1, now);
    player.tick(now);
    EXPECT_TRUE(player.queues[2].empty());
    now += 0.01;
    ASSERT_LT(now, 20);
  }
  EXPECT_TRUE(player.is_whole(1));
}

TEST(OnDemand, WhenAllAreExpelledNobodyIsWaitedFor) {
  Player player(make_options(AssignmentPolicy::on_demand, 2));
  player.machine.expel(1, 0);
  player.read();
  EXPECT_FALSE(player.all_lost);
  player.machine.expel(2, 0);
  player.read();
  EXPECT_TRUE(player.all_lost);
}

TEST(OnDemand, ALostNodeThatFailsIsExpelled) {
  Player player(make_options(AssignmentPolicy::on_demand, 1));
  player.tick(100);
  EXPECT_FALSE(player.all_lost);
  player.machine.expel(1, 101);  // its process is found to be gone
  player.read();
  EXPECT_TRUE(player.all_lost);
}

TEST(OnDemand, FortyNodesOfWhichMostAreLost) {
  // Node n falls silent at n/10 s, from 4 on; the work is done once and by the others.
  constexpr int kNodes = 40;
  AssignmentOptions options = make_options(AssignmentPolicy::on_demand, kNodes, 3);
  options.grid = make_grid(0, 0, 256, 256, kNodes);
  Player player(options);
  double now = 0;
  size_t released = 0;
  while (!player.machine.is_over()) {
    for (int node = 1; node <= kNodes; ++node) {
      if (node > 4 && now > 0.1 * node) continue;
      player.machine.hear(node, now);
      if (static_cast<int>(now * 20) % 5 == node % 5) player.step(node, now);
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

TEST(OnDemand, FailureIsTriedElsewhereAndThreeFailTheFrame) {
  Player player(make_options(AssignmentPolicy::on_demand, 2, 2));
  const AssignSubpolygon first = player.queues[1].front();
  player.queues[1].pop_front();
  player.machine.fail(1, first.frame, first.subpolygon, "boom", 0);
  player.read();
  EXPECT_TRUE(player.failed.empty());
  // Node 2 is full; the subpolygon comes to it next.
  player.step(2, 0);
  const auto& queue = player.queues[2];
  EXPECT_TRUE(std::any_of(queue.begin(), queue.end(), [&](const AssignSubpolygon& a) {
    return a.subpolygon == first.subpolygon && a.frame == 0;
  }));
  player.machine.fail(2, first.frame, first.subpolygon, "boom", 0);
  player.machine.fail(1, first.frame, first.subpolygon, "boom", 0);
  player.read();
  EXPECT_EQ(player.failed.at(0), "boom");
  player.machine.release(0, 0);
  player.read();
  double now = 0;
  while (player.complete.empty()) {  // the next frame is rendered all the same
    player.step(1, now);
    player.step(2, now);
    now += 0.01;
    ASSERT_LT(now, 10);
  }
  EXPECT_EQ(player.complete, std::vector<int>{1});
}

TEST(OnDemand, TheWindowBoundsTheFramesBegun) {
  AssignmentOptions options = make_options(AssignmentPolicy::on_demand, 2, 10);
  options.window_frames = 2;
  Player player(options);
  double now = 0;
  std::set<int> seen;
  for (int i = 0; i < 1000; ++i, now += 0.01) {
    for (const int node : {1, 2}) {
      for (const AssignSubpolygon& a : player.queues[node]) seen.insert(a.frame);
      player.step(node, now);
    }
  }
  EXPECT_EQ(seen, (std::set<int>{0, 1})) << "nothing was released, so no third frame may begin";
  player.machine.release(0, now);
  player.read();
  EXPECT_FALSE(player.queues[1].empty());
  EXPECT_EQ(player.queues[1].front().frame, 2);
}

/// Plays nodes that trace their own sets; `alive(node, now)` says which do.
template <typename Alive>
void play_interleaved(Player& player, int nodes, int frames, Alive alive) {
  std::map<int, std::deque<std::pair<int, int>>> own;
  std::map<int, int> next_frame;
  double now = 0;
  int released = 0;
  while (released < frames) {
    for (int node = 1; node <= nodes; ++node) {
      if (!alive(node, now)) continue;
      player.machine.hear(node, now);
      player.read();
      if (player.step(node, now)) continue;
      if (own[node].empty() && next_frame[node] < player.window_end) {
        const int frame = next_frame[node]++;
        for (const int s : interleaved_set(player.options.grid, nodes, frame, node - 1))
          own[node].push_back({frame, s});
      }
      if (own[node].empty()) continue;
      const auto [frame, subpolygon] = own[node].front();
      own[node].pop_front();
      player.done(node, frame, subpolygon, now);
    }
    player.tick(now);
    for (; released < static_cast<int>(player.complete.size()); ++released)
      player.machine.release(player.complete[static_cast<size_t>(released)], now);
    player.read();
    now += 0.1;
    ASSERT_LT(now, 300);
  }
}

TEST(Interleaved, NeedsNoAssignments) {
  Player player(make_options(AssignmentPolicy::interleaved, 3, 5));
  play_interleaved(player, 3, 5, [](int, double) { return true; });
  EXPECT_TRUE(player.is_whole(5));
  EXPECT_TRUE(player.queues[1].empty() && player.queues[2].empty() && player.queues[3].empty());
  EXPECT_TRUE(player.machine.is_over());
}

TEST(Interleaved, WhatALostNodeLeavesIsHandedOut) {
  Player player(make_options(AssignmentPolicy::interleaved, 3, 5));
  play_interleaved(player, 3, 5, [](int node, double now) { return node != 2 || now < 0.5; });
  EXPECT_TRUE(player.is_whole(5));
  EXPECT_EQ(player.lost, std::vector<int>{2});
}

TEST(Interleaved, ANodeThatComesBackDoesNoHarm) {
  Player player(make_options(AssignmentPolicy::interleaved, 3, 8));
  play_interleaved(player, 3, 8, [](int node, double now) { return node != 2 || now < 0.5 || now > 14; });
  EXPECT_TRUE(player.is_whole(8));
}

TEST(Assignment, NonsenseIsIgnored) {
  Player player(make_options(AssignmentPolicy::on_demand, 2));
  EXPECT_FALSE(player.machine.accept(1, 7, 0, 0));
  EXPECT_FALSE(player.machine.accept(1, 0, -1, 0));
  EXPECT_FALSE(player.machine.accept(1, 0, 100000, 0));
  player.machine.fail(1, -1, 0, "", 0);
}

}  // namespace
}  // namespace rayfarm
