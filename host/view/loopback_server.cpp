#include "host/view/loopback_server.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <httplib.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

namespace rayfarm {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds kMostToAsk{3}, kMostToAnswer{10};
/// A browser's headers are a tenth of it.
constexpr size_t kMostRequestBytes = 16 << 10;
constexpr size_t kThreads = 6;
/// Connections that wait for a thread; more wait in the system, which refuses what is too much.
constexpr size_t kMostWaiting = 16;

/// Threads for connections. Who brings one more than there is room for waits, so that no process runs out of
/// descriptors because of us.
class Places : public httplib::TaskQueue {
 public:
  Places() {
    for (size_t i = 0; i < kThreads; ++i)
      threads_.emplace_back([this](const std::stop_token& stop) { run(stop); });
  }
  void enqueue(std::function<void()> task) override {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return tasks_.size() < kMostWaiting; });
    tasks_.push_back(std::move(task));
    changed_.notify_all();
  }
  void shutdown() override {
    for (std::jthread& thread : threads_) thread.request_stop();
    threads_.clear();
  }

 private:
  void run(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (changed_.wait(lock, stop, [this] { return !tasks_.empty(); })) {
      const auto task = std::move(tasks_.front());
      tasks_.pop_front();
      changed_.notify_all();
      lock.unlock();
      task();
      lock.lock();
    }
  }
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<std::function<void()>> tasks_;
  std::vector<std::jthread> threads_;  // last: they look at the others
};

/// One connection, whose request and answer are bounded in time as a whole: the library bounds each read.
class Connection : public httplib::Stream {
 public:
  explicit Connection(socket_t socket) : socket_(socket), until_(Clock::now() + kMostToAsk) {}

  bool is_readable() const override { return begin_ < end_ || wait_for(POLLIN); }
  bool is_writable() const override { return wait_for(POLLOUT); }
  ssize_t read(char* out, size_t size) override {
    if (begin_ == end_) {
      if (taken_ >= kMostRequestBytes || !wait_for(POLLIN)) return -1;
      const ssize_t got = recv(socket_, buffer_.data(), buffer_.size(), MSG_DONTWAIT);
      if (got <= 0) return got;
      begin_ = 0;
      end_ = static_cast<size_t>(got);
      taken_ += end_;
    }
    const size_t count = std::min(size, end_ - begin_);
    std::memcpy(out, buffer_.data() + begin_, count);
    begin_ += count;
    return static_cast<ssize_t>(count);
  }
  ssize_t write(const char* bytes, size_t size) override {
    if (!std::exchange(is_answering_, true)) until_ = Clock::now() + kMostToAnswer;
    size_t sent = 0;
    while (sent < size) {
      if (!wait_for(POLLOUT)) return -1;
      const ssize_t count = send(socket_, bytes + sent, size - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
      if (count < 0 && errno != EAGAIN && errno != EINTR) return -1;
      sent += static_cast<size_t>(std::max<ssize_t>(0, count));
    }
    return static_cast<ssize_t>(size);
  }
  void get_remote_ip_and_port(std::string& ip, int& port) const override { ip = "127.0.0.1", port = 0; }
  void get_local_ip_and_port(std::string& ip, int& port) const override { ip = "127.0.0.1", port = 0; }
  socket_t socket() const override { return socket_; }

 private:
  bool wait_for(short event) const {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until_ - Clock::now()).count();
    pollfd descriptor{socket_, event, 0};
    return left > 0 && poll(&descriptor, 1, static_cast<int>(left)) == 1;
  }
  socket_t socket_;
  Clock::time_point until_;
  std::array<char, 4096> buffer_{};
  size_t begin_ = 0, end_ = 0, taken_ = 0;
  bool is_answering_ = false;
};

}  // namespace

class LoopbackServer::Server : public httplib::Server {
 public:
  Server(int port, Answer answer) : answer_(std::move(answer)) {
    set_address_family(AF_INET);
    // The library's own options let a second server share the port, and take requests of the first.
    set_socket_options([](socket_t socket) {
      const int yes = 1;
      setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
      fcntl(socket, F_SETFD, FD_CLOEXEC);
    });
    errno = 0;
    port_ = port == 0 ? bind_to_any_port("127.0.0.1") : bind_to_port("127.0.0.1", port) ? port : -1;
    if (port_ <= 0) throw std::runtime_error(std::strerror(errno != 0 ? errno : EADDRINUSE));
    set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
      respond(request, response);
      return HandlerResponse::Handled;
    });
    set_exception_handler([](const httplib::Request&, httplib::Response& response, std::exception_ptr) {
      response.status = 500;
    });
    auto places = std::make_unique<Places>();
    new_task_queue = [made = places.get()] { return made; };  // which the library deletes
    thread_ = std::thread([this] { listen_after_bind(); });
    places.release();
    while (!is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ~Server() override {
    {
      const std::lock_guard lock(mutex_);
      is_ending_ = true;
      for (const socket_t socket : open_) ::shutdown(socket, SHUT_RDWR);
    }
    stop();
    thread_.join();
  }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  int port() const { return port_; }

 private:
  bool process_and_close_socket(socket_t socket) override {
    bool is_answered = false;
    if (hold(socket)) {
      Connection connection(socket);
      bool is_closed = false;
      is_answered = process_request(connection, true, is_closed, [](httplib::Request& request) {
        // Answers are whole and plain: between two processes of a machine it costs more to compress them.
        request.headers.erase("Accept-Encoding");
        request.headers.erase("Range");
        request.ranges.clear();
      });
    }
    const std::lock_guard lock(mutex_);
    open_.erase(socket);
    ::shutdown(socket, SHUT_RDWR);
    close(socket);
    return is_answered;
  }
  bool hold(socket_t socket) {
    fcntl(socket, F_SETFD, FD_CLOEXEC);
    const std::lock_guard lock(mutex_);
    if (!is_ending_) open_.insert(socket);
    return !is_ending_;
  }
  void respond(const httplib::Request& request, httplib::Response& response) const {
    const std::string host = request.get_header_value("Host");
    HttpAnswer answer;
    if (request.get_header_value_count("Host") != 1 ||
        (host != fmt::format("127.0.0.1:{}", port_) && host != fmt::format("localhost:{}", port_)))
      answer = {403, "text/plain", "by this name nobody is served here\n"};
    else if (request.method != "GET")
      answer = {405, "text/plain", "only GET is answered\n"};
    else
      answer = answer_(request.path, request.get_param_value("since"));
    response.status = answer.status;
    response.set_header("Cache-Control", "no-store");
    response.set_header("Referrer-Policy", "no-referrer");  // else links would tell the token
    response.set_header("X-Content-Type-Options", "nosniff");
    response.set_header("X-Frame-Options", "DENY");
    response.set_header("Cross-Origin-Resource-Policy", "same-origin");
    response.set_header("Content-Security-Policy",
                        "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
                        "connect-src 'self'; img-src data:");
    response.set_content(std::move(answer.body), answer.type);
  }

  Answer answer_;
  int port_ = 0;
  std::mutex mutex_;
  std::set<socket_t> open_;
  bool is_ending_ = false;
  std::thread thread_;  // accepts
};

LoopbackServer::LoopbackServer(int port, Answer answer)
    : server_(std::make_unique<Server>(port, std::move(answer))) {}

LoopbackServer::~LoopbackServer() = default;

int LoopbackServer::port() const {
  return server_->port();
}

}  // namespace rayfarm
