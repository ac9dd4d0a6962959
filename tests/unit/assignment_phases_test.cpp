#include "tests/unit/assignment_player.h"

namespace rayfarm {
namespace {

using namespace test;

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
