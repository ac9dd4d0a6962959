#pragma once
// Pictures in tev (github.com/Tom94/tev), a viewer for high dynamic range: they grow there while they are
// rendered, in linear light. The protocol (its include/tev/Ipc.h): packets over TCP, each a little-endian
// length, a type and fields.
#include <atomic>
#include <deque>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "host/view/subpolygon_queue.h"
#include "host/view/watcher.h"

namespace rayfarm {

struct TevAddress {
  std::string host = "127.0.0.1", port = "14158";  ///< where tev listens by default
};

/// Of `tev://HOST[:PORT]`; an IPv6 address stands in brackets. Throws std::invalid_argument, which says what
/// is wrong.
TevAddress parse_tev_address(const std::string& text);

/// Sends what it sees in a thread of its own. A viewer that is not there, goes, or is too slow is told of
/// once; pictures can be made without it.
class TevDisplay : public Watcher {
 public:
  /// `tell` may be called by any thread. Throws std::runtime_error if there is no such host.
  TevDisplay(const TevAddress& address, std::function<void(const std::string&)> tell);
  ~TevDisplay() override;
  TevDisplay(const TevDisplay&) = delete;
  TevDisplay& operator=(const TevDisplay&) = delete;

  void begin(const WatchedJob& job) override;
  void see(const SeenSubpolygon& subpolygon) override;
  void hear(FarmStatus) override {}
  /// The job is over: waits a few seconds at most until the viewer has all.
  void end();

 private:
  struct Peer {
    std::vector<std::byte> address;  ///< a sockaddr
    int family = 0;
  };

  void run();
  bool connect_to_any();
  bool connect_to(const Peer& peer);
  /// False: the connection is gone, and it was said.
  bool send_packet(const std::vector<std::byte>& packet);
  bool send_frame(const SeenSubpolygon& subpolygon);
  bool send_subpolygon(const SeenSubpolygon& subpolygon);
  /// Until the socket is ready, or there is no more time.
  bool wait_for(short event, double until_s) const;
  void give_up(const std::string& problem);

  const std::string name_;  ///< for people
  std::function<void(const std::string&)> tell_;
  std::vector<Peer> peers_;
  WatchedJob job_;
  SubpolygonQueue queue_;
  int socket_ = -1;
  std::deque<FrameIndex> shown_;      ///< frames that the viewer has, in order
  std::atomic<double> end_s_{1e300};  ///< when nothing is waited for any more, see now_s
  std::thread thread_;
};

}  // namespace rayfarm
