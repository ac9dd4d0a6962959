#pragma once
// How messages travel between the host and its nodes. Both transports keep the order of messages between any
// two ends, never block, and may lose what is sent to a process that is gone. Any thread may send; one
// receives.
#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "protocol/clock.h"
#include "protocol/traffic_meter.h"

namespace rayfarm {

/// What a transfer holds: one command, several return-result commands of 9 bytes each, or a control message.
/// Whatever its channel, a transfer never overtakes an earlier one between the same two ends.
enum class Channel : uint8_t { command, pixels, control };

inline constexpr NodeId kHost{0};

struct Message {
  NodeId source = kHost;
  Channel channel = Channel::control;
  Bytes bytes;
};

/// The bytes of a message on its way: its own, or those of a broadcast, which all who get it share.
class Parcel {
 public:
  Parcel(Bytes own) : own_(std::move(own)) {}
  Parcel(std::shared_ptr<const Bytes> shared) : shared_(std::move(shared)) {}
  std::span<const std::byte> bytes() const { return shared_ ? *shared_ : own_; }
  /// For who gets it, once.
  Bytes take() { return shared_ ? *shared_ : std::move(own_); }

 private:
  Bytes own_;
  std::shared_ptr<const Bytes> shared_;
};

class Transport {
 public:
  virtual ~Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;
  int node_count() const { return nodes_; }
  /// True if all ends live and die together: none can be lost alone.
  virtual bool is_one_process() const = 0;

  /// Sends to one end and counts it.
  void send(NodeId to, Channel channel, Bytes bytes);
  void send(NodeId to, const Control& control) { send(to, Channel::control, encode_control(control)); }
  /// The host sends to every node; counted once.
  void broadcast(Channel channel, Bytes bytes);
  /// The host gives every node its load code (see encode_load_code); counted once. Where the nodes pass it on
  /// among each other, one that is lost meanwhile ends the job, at once if `names_the_gone` (see Watchdog)
  /// names it.
  void load_code(Bytes message, std::function<std::string()> names_the_gone);
  /// A part of a broadcast, to one node, in its own time; counted for the first of them.
  void send_of_broadcast(NodeId to, Channel channel, std::shared_ptr<const Bytes> bytes, bool is_first);
  /// What was sent to a node and has not been taken up there. An estimate: what the net holds may count as
  /// taken up.
  virtual size_t unsent_bytes(NodeId to) = 0;
  /// The next message, if one has come. Malformed commands are counted as one message.
  std::optional<Message> try_receive();
  /// Sleeps for so long, or until a message comes if the transport can tell.
  virtual void wait_for_message(double longest_s);

  /// When messages were last looked for, and something last sent to an end (see now_s), for other threads to
  /// To be called now and then by who has no time to look for messages, so that the heart goes on.
  void take_turn() { last_turn_s_ = now_s(); }
  /// ask.
  double last_turn_s() const { return last_turn_s_; }
  double last_sent_s(NodeId to) const { return sent_s_[to.place()]; }
  /// This end says something to each other at least so often while it lives (see Heart).
  double beat_s() const { return beat_s_; }
  void set_beat_s(double seconds) { beat_s_ = seconds; }

  /// Only the host's transport has a meter.
  bool is_host() const { return meter_ != nullptr; }
  TrafficMeter* meter() { return meter_.get(); }
  const TrafficMeter* meter() const { return meter_.get(); }

 protected:
  /// The end `self` of a net with so many nodes.
  Transport(int nodes, NodeId self);
  /// All that this end has to do with have lower places: the host with all nodes, a node with its host.
  size_t peers() const { return is_host() ? static_cast<size_t>(nodes_) + 1 : 1; }
  virtual void do_send(NodeId to, Channel channel, Parcel parcel) = 0;
  virtual void do_load_code(Bytes message, std::function<std::string()> names_the_gone);
  virtual std::optional<Message> do_try_receive() = 0;

 private:
  void send_to_all(Channel channel, Bytes bytes);
  void send_parcel(NodeId to, Channel channel, Parcel parcel);
  void count(NodeId node, Direction direction, Channel channel, std::span<const std::byte> bytes);
  int nodes_;
  std::unique_ptr<TrafficMeter> meter_;
  std::vector<std::atomic<double>> sent_s_;
  std::atomic<double> beat_s_, last_turn_s_ = now_s();
};

/// Sleeps longer the longer nothing happens, so that waiting costs almost no processor time.
class Backoff {
 public:
  void reset() { idle_ = 0; }
  void wait();
  /// The same for who waits for messages.
  void wait_for(Transport& transport) { transport.wait_for_message(next_nap_s()); }

 private:
  double next_nap_s();
  int idle_ = 0;
};

}  // namespace rayfarm
