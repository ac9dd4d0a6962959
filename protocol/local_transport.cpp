#include "protocol/local_transport.h"

#include <chrono>
#include <condition_variable>
#include <list>
#include <mutex>

namespace rayfarm {
namespace {

/// The inboxes of all ends.
struct Hub {
  explicit Hub(int nodes) : inboxes(static_cast<size_t>(nodes) + 1) {}
  struct Letter {
    NodeId source;
    Channel channel;
    Parcel parcel;
  };
  struct Inbox {
    std::mutex mutex;
    std::condition_variable came;
    std::list<Letter> messages;
    size_t bytes = 0;  ///< of all messages
  };
  std::vector<Inbox> inboxes;
};

class LocalTransport : public Transport {
 public:
  LocalTransport(const std::shared_ptr<Hub>& hub, NodeId self)
      : Transport(static_cast<int>(hub->inboxes.size()) - 1, self), hub_(hub), self_(self) {}
  bool is_one_process() const override { return true; }
  size_t unsent_bytes(NodeId to) override {
    Hub::Inbox& inbox = hub_->inboxes.at(to.place());
    const std::lock_guard lock(inbox.mutex);
    return inbox.bytes;
  }
  void wait_for_message(double longest_s) override {
    Hub::Inbox& inbox = hub_->inboxes[self_.place()];
    std::unique_lock lock(inbox.mutex);
    inbox.came.wait_for(lock, std::chrono::duration<double>(longest_s),
                        [&] { return !inbox.messages.empty(); });
  }

 protected:
  void do_send(NodeId to, Channel channel, Parcel parcel) override {
    Hub::Inbox& inbox = hub_->inboxes.at(to.place());
    {
      const std::lock_guard lock(inbox.mutex);
      inbox.bytes += parcel.bytes().size();
      inbox.messages.push_back({self_, channel, std::move(parcel)});
    }
    inbox.came.notify_one();
  }
  std::optional<Message> do_try_receive() override {
    Hub::Inbox& inbox = hub_->inboxes[self_.place()];
    std::list<Hub::Letter> taken;  // a broadcast's bytes are copied while nobody waits for the inbox
    {
      const std::lock_guard lock(inbox.mutex);
      if (inbox.messages.empty()) return std::nullopt;
      taken.splice(taken.begin(), inbox.messages, inbox.messages.begin());
      inbox.bytes -= taken.front().parcel.bytes().size();
    }
    Hub::Letter& letter = taken.front();
    return Message{letter.source, letter.channel, letter.parcel.take()};
  }

 private:
  std::shared_ptr<Hub> hub_;
  NodeId self_;
};

}  // namespace

std::vector<std::unique_ptr<Transport>> make_local_transports(int nodes) {
  const auto hub = std::make_shared<Hub>(nodes);
  std::vector<std::unique_ptr<Transport>> ends;
  for (NodeId i; i.value() <= nodes; ++i) ends.push_back(std::make_unique<LocalTransport>(hub, i));
  return ends;
}

}  // namespace rayfarm
