#include "host/view/view_server.h"

#include <fmt/core.h>
#include <sys/random.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <stdexcept>
#include <thread>

#include "host/view/page.h"
#include "protocol/clock.h"

namespace rayfarm {
namespace {

constexpr double kPageIsOpen_s = 2;
constexpr std::chrono::milliseconds kFarewell{1200};

/// 128 bits of the system's random source.
std::string make_token() {
  std::array<unsigned char, 16> bytes{};
  if (getentropy(bytes.data(), bytes.size()) != 0)
    throw std::runtime_error(fmt::format("the system has no random numbers: {}", std::strerror(errno)));
  std::string token;
  for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

/// In a time that tells nothing of where they differ.
bool begins_with(const std::string& text, const std::string& secret) {
  if (text.size() < secret.size()) return false;
  unsigned difference = 0;
  for (size_t i = 0; i < secret.size(); ++i)
    difference |= static_cast<unsigned>(static_cast<unsigned char>(text[i])) ^
                  static_cast<unsigned>(static_cast<unsigned char>(secret[i]));
  return difference == 0;
}

}  // namespace

ViewServer::ViewServer(int port, const FarmView& view) : view_(view), token_(make_token()) {
  server_.emplace(port,
                  [this](const std::string& path, const std::string& since) { return answer(path, since); });
}

std::string ViewServer::url() const {
  return fmt::format("http://127.0.0.1:{}/{}/", server_->port(), token_);
}

void ViewServer::let_pages_see_the_end() const {
  if (now_s() - asked_s_ < kPageIsOpen_s) std::this_thread::sleep_for(kFarewell);
}

HttpAnswer ViewServer::answer(const std::string& path, const std::string& since) {
  if (!begins_with(path, "/" + token_)) return {};
  const std::string rest = path.substr(1 + token_.size());
  if (rest == "/") return {200, "text/html; charset=utf-8", kViewPage};
  if (rest == "/state") {
    asked_s_ = now_s();
    return {200, "application/json", view_.state()};
  }
  if (rest == "/updates") {
    uint64_t number = 0;
    const auto [end, error] = std::from_chars(since.data(), since.data() + since.size(), number);
    if (error != std::errc{} || end != since.data() + since.size())
      return {400, "text/plain", "/updates?since=N: N is a whole number\n"};
    return {200, "application/octet-stream", view_.updates(number)};
  }
  return {};
}

}  // namespace rayfarm
