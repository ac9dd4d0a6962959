#pragma once
// A small HTTP server for the users of this machine: it listens on 127.0.0.1 alone, answers GET alone, each
// connection once, and only who asks for it by that name (else any page that a browser shows could reach it,
// by a name of its own that leads here). Time, size and number of requests are bounded: who sends nonsense,
// or nothing, takes one of a few places for a few seconds. It never opens a file.
#include <functional>
#include <memory>
#include <string>

namespace rayfarm {

struct HttpAnswer {
  int status = 404;
  std::string type = "text/plain", body{};
};

class LoopbackServer {
 public:
  /// Called by several threads at once. `since` is the request's parameter of that name, or empty.
  using Answer = std::function<HttpAnswer(const std::string& path, const std::string& since)>;

  /// Serves from now on. 0: any port that is free. Throws std::runtime_error, which says why, if the port
  /// can't be had.
  LoopbackServer(int port, Answer answer);
  /// Connections that are open are cut.
  ~LoopbackServer();
  LoopbackServer(const LoopbackServer&) = delete;
  LoopbackServer& operator=(const LoopbackServer&) = delete;

  int port() const;

 private:
  class Server;
  std::unique_ptr<Server> server_;
};

}  // namespace rayfarm
