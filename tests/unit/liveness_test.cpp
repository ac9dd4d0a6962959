#include "protocol/liveness.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <map>

#include "protocol/build_identity.h"
#include "protocol/local_transport.h"

namespace rayfarm {
namespace {

TEST(ListeningClock, OwnPausesDoNotCount) {
  ListeningClock clock;
  clock.turn(100);
  for (int i = 1; i <= 10; ++i) clock.turn(100 + 0.1 * i);
  EXPECT_NEAR(clock.now(), 1, 1e-9);
  clock.turn(121);  // stopped for 20 s
  EXPECT_LT(clock.now(), 1.6);
  const double before = clock.now();
  clock.turn(121.2);
  EXPECT_NEAR(clock.now() - before, 0.2, 1e-9);
  clock.turn(0);  // no clock goes back, but if one did, no time would be lost
  EXPECT_GE(clock.now(), before);
}

/// A copy of this process that only waits.
pid_t start_child() {
  const pid_t child = fork();
  if (child == 0) {
    while (true) pause();
  }
  return child;
}

TEST(ProcessSign, AProcessThatEndedIsGoneAlsoBeforeItIsReaped) {
  const pid_t child = start_child();
  const ProcessSign sign(machine_name(), static_cast<uint32_t>(child));
  EXPECT_FALSE(sign.is_gone());
  kill(child, SIGSTOP);
  EXPECT_FALSE(sign.is_gone()) << "stopped is not gone";
  kill(child, SIGKILL);
  for (int i = 0; i < 1000 && !sign.is_gone(); ++i) usleep(1000);
  EXPECT_TRUE(sign.is_gone());
  waitpid(child, nullptr, 0);
  EXPECT_TRUE(sign.is_gone());
}

TEST(ProcessSign, WhatWasNeverSeenIsNeverGone) {
  const pid_t child = start_child();
  const ProcessSign elsewhere("another-machine", static_cast<uint32_t>(child));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_FALSE(elsewhere.is_gone());
  EXPECT_FALSE(ProcessSign(machine_name(), static_cast<uint32_t>(child)).is_gone());
  EXPECT_FALSE(ProcessSign(machine_name(), 1).is_gone()) << "another program";
  EXPECT_FALSE(ProcessSign().is_gone());
}

TEST(Witness, NamesTheGoneAfterItsGrace) {
  const pid_t child = start_child();
  const ProcessSign sign(machine_name(), static_cast<uint32_t>(child));
  const auto at_once = make_witness({{"node 1", ProcessSign()}, {"node 2", sign}}, 0);
  const auto later = make_witness({{"node 2", sign}}, 0.3);
  EXPECT_EQ(at_once(), "");
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_EQ(at_once().find("node 2 (process "), 0u);
  EXPECT_EQ(later(), "");
  usleep(400'000);
  EXPECT_NE(later(), "");
}

TEST(Heart, BeatsWhileTheProcessComputes) {
  const auto ends = make_local_transports(2);
  {
    const Heart host(*ends[0]), node(*ends[1]);
    usleep(2'500'000);  // nobody polls
  }
  const auto beats = [](Transport& end) {
    int n = 0;
    while (const auto message = end.try_receive())
      n += std::holds_alternative<Alive>(decode_control(message->bytes)) ? 1 : 0;
    return n;
  };
  EXPECT_EQ(beats(*ends[0]), 2);
  EXPECT_EQ(beats(*ends[1]), 2);
  EXPECT_EQ(beats(*ends[2]), 2);
}

TEST(Heart, WhoIsToldSomethingElseIsToldNoMore) {
  const auto ends = make_local_transports(2);
  const auto beats = [](Transport& end) {
    std::map<NodeId, int> heard;
    while (const auto message = end.try_receive())
      heard[message->source] += std::holds_alternative<Alive>(decode_control(message->bytes)) ? 1 : 0;
    return heard;
  };
  {
    const Heart host(*ends[0]), talks(*ends[1]), waits(*ends[2]);
    for (int i = 0; i < 25; ++i) {
      usleep(100'000);
      ends[0]->send(NodeId(1), AskPresent{});
      ends[1]->send(kHost, Present{});
    }
  }
  std::map<NodeId, int> at_host = beats(*ends[0]);
  EXPECT_EQ(at_host[NodeId(1)], 0);
  EXPECT_EQ(at_host[NodeId(2)], 2);
  EXPECT_EQ(beats(*ends[1])[kHost], 0);
  EXPECT_EQ(beats(*ends[2])[kHost], 2);
}

TEST(Heart, BeatsAsOftenAsThePlanSays) {
  const auto ends = make_local_transports(1);
  ends[1]->set_beat_s(0.25);
  {
    const Heart node(*ends[1]);
    usleep(1'200'000);
  }
  int beats = 0;
  while (ends[0]->try_receive()) ++beats;
  EXPECT_GE(beats, 4);
  EXPECT_LE(beats, 5);
}

TEST(Beat, IsRarerTheMoreThereAreAndFourTimesInASilenceThatCounts) {
  EXPECT_EQ(liveness::beat_s(1), 1);
  EXPECT_EQ(liveness::beat_s(1000), 1);
  EXPECT_EQ(liveness::beat_s(1500), 1.5);
  EXPECT_EQ(liveness::beat_s(16'383), 2) << "a quarter of 8 s";
  EXPECT_EQ(liveness::beat_s(16'383, 2), 1) << "half of 2 s, as for few";
  EXPECT_EQ(liveness::beat_s(16'383, 16), 4);
  EXPECT_EQ(liveness::beat_s(16'383, 3600), 8);
  EXPECT_EQ(liveness::beat_s(3000, 3600), 3);
}

TEST(Heart, FallsSilentWhenTheProcessHangs) {
  const auto ends = make_local_transports(2);
  ends[1]->try_receive();
  ends[2]->try_receive();
  {
    const Heart hangs(*ends[1], 1.5), turns(*ends[2], 1.5);
    for (int i = 0; i < 35; ++i) {
      usleep(100'000);
      ends[2]->try_receive();
    }
  }
  std::map<NodeId, int> beats;
  while (const auto message = ends[0]->try_receive()) ++beats[message->source];
  EXPECT_EQ(beats[NodeId(1)], 1);
  EXPECT_EQ(beats[NodeId(2)], 3);
}

}  // namespace
}  // namespace rayfarm
