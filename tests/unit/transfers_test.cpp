// Messages on their way, with a net that does what the test says.
#include "protocol/transfers.h"

#include <gtest/gtest.h>

#include <map>

#include "protocol/local_transport.h"
#include "protocol/phase_data.h"

namespace rayfarm {
namespace {

/// Transfers are known by numbers; all are on their way until the test says otherwise.
struct FakeNet {
  std::map<int, TransferState> states;
  int asked = 0;
  auto asker() {
    return [this](int& request) {
      ++asked;
      const auto state = states.find(request);
      return state == states.end() ? TransferState::on_its_way : state->second;
    };
  }
};

Message numbered(int source, int number) {
  return {NodeId(source), Channel::command, Bytes{static_cast<std::byte>(number)}};
}

int number_of(const std::optional<Message>& message) {
  return message ? std::to_integer<int>(message->bytes[0]) : -1;
}

TEST(Departures, WhatHasLeftIsLetGo) {
  FakeNet net;
  Departures<int> departures(3);
  departures.add(NodeId(1), Bytes(10), 1);
  departures.add(NodeId(1), Bytes(5), 2);
  departures.add(NodeId(2), Bytes(7), 3);
  net.states[2] = TransferState::done;
  departures.settle(NodeId(1), net.asker());
  EXPECT_EQ(departures.unsent_bytes(NodeId(1)), 15u) << "the first has not left";
  net.states[1] = TransferState::failed;
  departures.settle(NodeId(1), net.asker());
  EXPECT_EQ(departures.unsent_bytes(NodeId(1)), 0u);
  EXPECT_EQ(departures.unsent_bytes(NodeId(2)), 7u);
}

TEST(Departures, ASendAsksOfNoMoreThanAFewOthers) {
  FakeNet net;
  constexpr int kEnds = 10'000;
  Departures<int> departures(kEnds + 1);
  for (int end = 1; end <= kEnds; ++end) {
    departures.settle_some(net.asker());
    departures.add(NodeId(end), Bytes(1), end);
  }
  EXPECT_LE(net.asked, 2 * kEnds);
  // All but one leave; that one holds up nobody else.
  for (int end = 2; end <= kEnds; ++end) net.states[end] = TransferState::done;
  for (int i = 0; i < kEnds; ++i) departures.settle_some(net.asker());
  EXPECT_EQ(departures.unsent_bytes(NodeId(1)), 1u);
  for (int end = 2; end <= kEnds; ++end) ASSERT_EQ(departures.unsent_bytes(NodeId(end)), 0u);
  net.asked = 0;
  departures.settle_some(net.asker());
  EXPECT_LE(net.asked, 2);
}

TEST(Arrivals, OrderHoldsAndWhatNeverEndsHoldsUpItsOwnSource) {
  FakeNet net;
  Arrivals<int> arrivals(4);
  arrivals.add(numbered(1, 10), 10, net.asker());  // its sender died in the middle of it
  for (const int number : {11, 12}) {
    net.states[number] = TransferState::done;
    arrivals.add(numbered(1, number), number, net.asker());
  }
  for (const int number : {20, 21, 30}) {
    net.states[number] = TransferState::done;
    arrivals.add(numbered(number / 10, number), number, net.asker());
  }
  EXPECT_EQ(number_of(arrivals.take(net.asker())), 20);
  EXPECT_EQ(number_of(arrivals.take(net.asker())), 30);
  EXPECT_EQ(number_of(arrivals.take(net.asker())), 21);
  arrivals.look(net.asker());
  EXPECT_FALSE(arrivals.take(net.asker()));
  net.states[10] = TransferState::failed;
  arrivals.look(net.asker());
  EXPECT_EQ(number_of(arrivals.take(net.asker())), 11) << "what failed is lost, and no more";
  EXPECT_EQ(number_of(arrivals.take(net.asker())), 12);
  EXPECT_FALSE(arrivals.is_any_ready());
}

TEST(Arrivals, SourcesTakeTurns) {
  FakeNet net;
  Arrivals<int> arrivals(3);
  for (int i = 0; i < 100; ++i) net.states[i] = TransferState::done;
  for (int i = 0; i < 99; ++i) arrivals.add(numbered(1, i), i, net.asker());
  arrivals.add(numbered(2, 99), 99, net.asker());
  EXPECT_EQ(number_of(arrivals.take(net.asker())), 0);
  EXPECT_EQ(number_of(arrivals.take(net.asker())), 99);
  for (int i = 1; i < 99; ++i) ASSERT_EQ(number_of(arrivals.take(net.asker())), i);
}

TEST(Arrivals, ALookAsksOfAFewSourcesAndOfAllInTurn) {
  FakeNet net;
  constexpr int kSources = 1000;
  Arrivals<int> arrivals(kSources + 1);
  for (int source = 1; source <= kSources; ++source) arrivals.add(numbered(source, 7), source, net.asker());
  net.asked = 0;
  arrivals.look(net.asker());
  EXPECT_LE(net.asked, 20);
  net.states[kSources] = TransferState::done;
  for (int i = 0; i < kSources && !arrivals.is_any_ready(); ++i) arrivals.look(net.asker());
  EXPECT_EQ(arrivals.take(net.asker())->source, NodeId(kSources));
}

TEST(LocalTransport, EachEndGetsABroadcastWhole) {
  const auto ends = make_local_transports(3);
  const Bytes sent = encode_load_code(Bytes(64, std::byte{5}));
  ends[0]->broadcast(Channel::command, sent);
  for (size_t i = 1; i <= 3; ++i) EXPECT_EQ(ends[i]->try_receive()->bytes, sent);
}

/// Takes up nothing at some nodes, and counts who was asked about.
class SlowNet : public Transport {
 public:
  explicit SlowNet(int nodes) : Transport(nodes, kHost), sent(peers()) {}
  bool is_one_process() const override { return false; }
  size_t unsent_bytes(NodeId to) override {
    ++asked;
    return to.value() % 10 == 0 ? sent[to.place()] : 0;
  }
  std::vector<size_t> sent;
  int asked = 0;

 protected:
  void do_send(NodeId to, Channel, Parcel parcel) override { sent[to.place()] += parcel.bytes().size(); }
  std::optional<Message> do_try_receive() override { return std::nullopt; }
};

TEST(DataFeed, OnlyNodesThatLackSomethingAreLookedAt) {
  constexpr int kNodes = 1000;
  SlowNet net(kNodes);
  DataFeed feed(net, kStageAddress, Bytes(6 * kChunkBytes - 100));
  for (int i = 0; i < 100; ++i) feed.turn();
  for (int node = 1; node <= kNodes; ++node)
    ASSERT_GE(net.sent[static_cast<size_t>(node)], (node % 10 == 0 ? 3 : 6) * kChunkBytes - 100) << node;
  feed.leave_out(NodeId(10));
  net.asked = 0;
  EXPECT_FALSE(feed.turn());
  EXPECT_LE(net.asked, kNodes / 10);
  EXPECT_GE(net.asked, kNodes / 10 - 1);
  EXPECT_EQ(net.meter()->total(Command::load_data).messages, 6u) << "a broadcast counts once";
}

}  // namespace
}  // namespace rayfarm
