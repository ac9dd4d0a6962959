#pragma once
// Messages on their way between this end and many others, where each takes its time and the net must be asked
// whether it is over: whom to ask when, so that a message costs the same among two ends and among thousands.
// Knows no MPI: `ask` tells of a request what has become of it. Each pair of ends keeps its order, and what
// never ends holds up only what is behind it.
#include <deque>
#include <list>
#include <optional>
#include <utility>
#include <vector>

#include "protocol/transport.h"

namespace rayfarm {

enum class TransferState : uint8_t { on_its_way, done, failed };

/// What has been sent, until it has left.
template <typename Request>
class Departures {
 public:
  /// To ends 0 to `ends` − 1.
  explicit Departures(size_t ends) : ends_(ends) {}

  /// The parcel's bytes stay where they are while they are on their way.
  void add(NodeId to, Parcel parcel, Request request) {
    End& end = ends_[to.place()];
    end.bytes += parcel.bytes().size();
    end.sends.emplace_back(std::move(parcel), request);
    if (!std::exchange(end.is_listed, true)) busy_.push_back(to);
  }

  /// Lets go of what has left for one end, in order: the first that has not is all that is asked about.
  template <typename Ask>
  void settle(NodeId to, const Ask& ask) {
    End& end = ends_[to.place()];
    while (!end.sends.empty() && ask(end.sends.front().second) != TransferState::on_its_way) {
      end.bytes -= end.sends.front().first.bytes().size();
      end.sends.pop_front();
    }
  }
  /// The same for the next few of the ends for which something is on its way: called for each message that
  /// is sent, more than keeps up.
  template <typename Ask>
  void settle_some(const Ask& ask) {
    constexpr int kEnds = 2;
    for (int i = 0; i < kEnds && !busy_.empty(); ++i) {
      const NodeId to = busy_.front();
      busy_.pop_front();
      settle(to, ask);
      if (ends_[to.place()].sends.empty())
        ends_[to.place()].is_listed = false;
      else
        busy_.push_back(to);
    }
  }

  size_t unsent_bytes(NodeId to) const { return ends_[to.place()].bytes; }

 private:
  struct End {
    std::list<std::pair<Parcel, Request>> sends;
    size_t bytes = 0;
    bool is_listed = false;  ///< stands in busy_
  };
  std::vector<End> ends_;
  std::deque<NodeId> busy_;  ///< ends with sends, and some that have none any more
};

/// What is being received, until it is taken. Sources take turns, however much one sends.
template <typename Request>
class Arrivals {
 public:
  /// From ends 0 to `ends` − 1.
  explicit Arrivals(size_t ends) : queues_(ends) {}

  /// A message that has begun to come. The message's bytes stay where they are until it is taken.
  template <typename Ask>
  void add(Message message, Request request, const Ask& ask) {
    const NodeId source = message.source;
    auto& queue = queues_[source.place()];
    queue.emplace_back(std::move(message), request);
    if (queue.size() == 1) place(source, ask);
  }

  /// Asks about the next few of the sources that are waited for.
  template <typename Ask>
  void look(const Ask& ask) {
    constexpr size_t kSources = 16;
    for (size_t i = std::min(kSources, waiting_.size()); i > 0; --i) {
      const NodeId source = waiting_.front();
      waiting_.pop_front();
      place(source, ask);
    }
  }

  bool is_any_ready() const { return !ready_.empty(); }
  /// A message that is whole.
  template <typename Ask>
  std::optional<Message> take(const Ask& ask) {
    if (ready_.empty()) return std::nullopt;
    const NodeId source = ready_.front();
    ready_.pop_front();
    auto& queue = queues_[source.place()];
    Message message = std::move(queue.front().first);
    queue.pop_front();
    place(source, ask);
    return message;
  }

 private:
  /// Puts a source, if it has messages, where its first one belongs.
  template <typename Ask>
  void place(NodeId source, const Ask& ask) {
    auto& queue = queues_[source.place()];
    while (!queue.empty()) {
      const TransferState state = ask(queue.front().second);
      if (state ==
          TransferState::failed) {  // the sender was lost in the middle: what it sent is lost with it
        queue.pop_front();
        continue;
      }
      (state == TransferState::done ? ready_ : waiting_).push_back(source);
      return;
    }
  }

  std::vector<std::list<std::pair<Message, Request>>> queues_;
  std::deque<NodeId> ready_, waiting_;  ///< sources, by whether the first of their messages is whole
};

}  // namespace rayfarm
