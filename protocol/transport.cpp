#include "protocol/transport.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "protocol/time_limits.h"

namespace rayfarm {

Transport::Transport(int nodes, NodeId self)
    : nodes_(nodes),
      meter_(self == kHost ? std::make_unique<TrafficMeter>(nodes) : nullptr),
      sent_s_(peers()),
      beat_s_(liveness::beat_s(nodes)) {
  for (std::atomic<double>& sent : sent_s_) sent = now_s();
}

void Transport::send_parcel(NodeId to, Channel channel, Parcel parcel) {
  sent_s_[to.place()] = now_s();
  do_send(to, channel, std::move(parcel));
}

void Transport::count(NodeId node, Direction direction, Channel channel, std::span<const std::byte> bytes) {
  if (!meter_) return;
  if (channel == Channel::control || bytes.size() < 2) {
    meter_->count_control(node, direction, {1, bytes.size()});
    return;
  }
  const Command command = command_of(bytes);
  const uint64_t messages = channel == Channel::pixels ? bytes.size() / kPixelBytes : 1;
  meter_->count_command(node, direction, command, {messages, bytes.size()});
}

void Transport::send(NodeId to, Channel channel, Bytes bytes) {
  count(to, Direction::to_node, channel, bytes);
  send_parcel(to, channel, std::move(bytes));
}

void Transport::broadcast(Channel channel, Bytes bytes) {
  count(kHost, Direction::to_node, channel, bytes);
  send_to_all(channel, std::move(bytes));
}

void Transport::load_code(Bytes message, std::function<std::string()> names_the_gone) {
  count(kHost, Direction::to_node, Channel::command, message);
  do_load_code(std::move(message), std::move(names_the_gone));
}

void Transport::do_load_code(Bytes message, std::function<std::string()>) {
  send_to_all(Channel::command, std::move(message));
}

void Transport::send_to_all(Channel channel, Bytes bytes) {
  const auto shared = std::make_shared<const Bytes>(std::move(bytes));
  for (NodeId node(1); node.value() <= node_count(); ++node) send_parcel(node, channel, shared);
}

void Transport::send_of_broadcast(NodeId to, Channel channel, std::shared_ptr<const Bytes> bytes,
                                  bool is_first) {
  if (is_first) count(kHost, Direction::to_node, channel, *bytes);
  send_parcel(to, channel, std::move(bytes));
}

std::optional<Message> Transport::try_receive() {
  last_turn_s_ = now_s();
  auto message = do_try_receive();
  if (message) count(message->source, Direction::to_host, message->channel, message->bytes);
  return message;
}

void Transport::wait_for_message(double longest_s) {
  std::this_thread::sleep_for(std::chrono::duration<double>(longest_s));
}

void Backoff::wait() {
  std::this_thread::sleep_for(std::chrono::duration<double>(next_nap_s()));
}

double Backoff::next_nap_s() {
  // 40 µs at first, doubling every two waits up to the longest nap. A poll costs a few µs, as much as a tenth
  // of a result: an idle process stays far below 1 % of a core, one that answers now and then below 2 %, and
  // an answer to a fresh event comes fast.
  const int doublings = std::min(idle_++ / 2, 7);
  return std::min(40e-6 * (1 << doublings), liveness::kLongestNap_s);
}

}  // namespace rayfarm
