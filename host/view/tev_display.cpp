#include "host/view/tev_display.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <stdexcept>

#include "common/image/pixel_layout.h"
#include "protocol/byte_stream.h"
#include "protocol/clock.h"

namespace rayfarm {
namespace {

constexpr double kConnect_s = 5, kStalled_s = 20, kFarewell_s = 5;
/// Of an animation: the viewer holds all that it is given, as floats.
constexpr size_t kMostFrames = 4;
constexpr double kLook_s = 0.2;

/// As tev numbers them.
enum class TevPacket : uint8_t { close_image = 2, create_image = 4, update_image_v3 = 6 };

class PacketWriter {
 public:
  explicit PacketWriter(TevPacket type) {
    bytes_.u32(0);
    bytes_.u8(static_cast<uint8_t>(type));
  }
  PacketWriter& flag(bool value) {
    bytes_.u8(value ? 1 : 0);
    return *this;
  }
  PacketWriter& text(std::string_view value) {
    bytes_.bytes(std::as_bytes(std::span(value)));
    bytes_.u8(0);
    return *this;
  }
  PacketWriter& i32(int value) {
    bytes_.u32(static_cast<uint32_t>(value));
    return *this;
  }
  PacketWriter& i64(size_t value) {
    bytes_.u64(value);
    return *this;
  }
  PacketWriter& f32(float value) {
    bytes_.u32(std::bit_cast<uint32_t>(value));
    return *this;
  }
  Bytes take() {
    Bytes packet = bytes_.take();
    for (size_t i = 0; i < 4; ++i) packet[i] = static_cast<std::byte>(packet.size() >> (8 * i) & 0xff);
    return packet;
  }

 private:
  ByteWriter bytes_;
};

}  // namespace

TevAddress parse_tev_address(const std::string& text) {
  constexpr std::string_view kScheme = "tev://";
  if (!text.starts_with(kScheme)) throw std::invalid_argument("is not of the form tev://HOST[:PORT]");
  std::string rest = text.substr(kScheme.size());
  if (rest.ends_with('/')) rest.pop_back();
  TevAddress address;
  const size_t bracket = rest.find(']');
  const bool is_ipv6 = rest.starts_with('[') && bracket != std::string::npos;
  const size_t colon = rest.find(':', is_ipv6 ? bracket : 0);
  address.host = is_ipv6 ? rest.substr(1, bracket - 1) : rest.substr(0, colon);
  if (address.host.empty()) throw std::invalid_argument("names no host");
  if (is_ipv6 && bracket + 1 != std::min(colon, rest.size()))
    throw std::invalid_argument("is not of the form tev://[ADDRESS]:PORT");
  if (colon == std::string::npos) return address;
  address.port = rest.substr(colon + 1);
  int port = 0;
  const auto [end, error] =
      std::from_chars(address.port.data(), address.port.data() + address.port.size(), port);
  if (error != std::errc{} || end != address.port.data() + address.port.size() || port < 1 || port > 65535)
    throw std::invalid_argument(fmt::format("'{}' is no port from 1 to 65535", address.port));
  return address;
}

TevDisplay::TevDisplay(const TevAddress& address, std::function<void(const std::string&)> tell)
    : name_(fmt::format("tev://{}:{}", address.host, address.port)), tell_(std::move(tell)) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int error = getaddrinfo(address.host.c_str(), address.port.c_str(), &hints, &found); error != 0)
    throw std::runtime_error(gai_strerror(error));
  for (const addrinfo* a = found; a; a = a->ai_next) {
    const auto bytes = std::as_bytes(std::span(a->ai_addr, 1));
    peers_.push_back({{bytes.data(), bytes.data() + a->ai_addrlen}, a->ai_family});
  }
  freeaddrinfo(found);
}

TevDisplay::~TevDisplay() {
  end_s_ = 0;
  queue_.abandon();
  if (thread_.joinable()) thread_.join();
}

void TevDisplay::begin(const WatchedJob& job) {
  job_ = job;
  thread_ = std::thread([this] { run(); });
}

void TevDisplay::see(const SeenSubpolygon& subpolygon) {
  queue_.push(subpolygon);
}

void TevDisplay::end() {
  end_s_ = now_s() + kFarewell_s;
  queue_.close();
  if (thread_.joinable()) thread_.join();
  thread_ = {};
  if (const uint64_t dropped = queue_.dropped(); dropped > 0 && socket_ >= 0)
    tell_(
        fmt::format("--display {}: the viewer took what came more slowly than it came; {} results are not "
                    "shown there. The files have them",
                    name_, dropped));
  if (socket_ >= 0) close(socket_);
  socket_ = -1;
}

void TevDisplay::run() {
  if (!connect_to_any()) return;
  while (const auto item = queue_.pop()) {
    if (!send_frame(item->subpolygon) || !send_subpolygon(item->subpolygon)) return;
    if (now_s() > end_s_) return give_up("takes the rest too slowly");
  }
}

bool TevDisplay::connect_to_any() {
  int problem = 0;
  for (const Peer& peer : peers_) {
    if (connect_to(peer)) return true;
    problem = errno;
  }
  give_up(
      fmt::format("can't be reached ({}); is tev running there? It listens at 127.0.0.1:14158 unless it "
                  "was started with --hostname",
                  std::strerror(problem)));
  return false;
}

bool TevDisplay::connect_to(const Peer& peer) {
  socket_ = socket(peer.family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (socket_ < 0) return false;
  int problem = 0;
  if (connect(socket_, reinterpret_cast<const sockaddr*>(peer.address.data()),
              static_cast<socklen_t>(peer.address.size())) != 0) {
    problem = errno;
    if (problem == EINPROGRESS) {
      socklen_t size = sizeof problem;
      if (!wait_for(POLLOUT, now_s() + kConnect_s))
        problem = ETIMEDOUT;
      else if (getsockopt(socket_, SOL_SOCKET, SO_ERROR, &problem, &size) != 0)
        problem = errno;
    }
  }
  if (problem == 0) return true;
  close(socket_);
  socket_ = -1;
  errno = problem;
  return false;
}

bool TevDisplay::wait_for(short event, double until_s) const {
  for (;;) {
    pollfd descriptor{socket_, event, 0};
    if (poll(&descriptor, 1, static_cast<int>(1000 * kLook_s)) == 1) return true;
    if (now_s() > std::min(until_s, end_s_.load())) return false;
  }
}

bool TevDisplay::send_packet(const std::vector<std::byte>& packet) {
  size_t sent = 0;
  while (sent < packet.size()) {
    if (!wait_for(POLLOUT, now_s() + kStalled_s)) {
      give_up("takes nothing any more");
      return false;
    }
    const ssize_t count = send(socket_, packet.data() + sent, packet.size() - sent, MSG_NOSIGNAL);
    if (count < 0 && errno != EAGAIN && errno != EINTR) {
      give_up(fmt::format("is gone ({})", std::strerror(errno)));
      return false;
    }
    sent += static_cast<size_t>(std::max<ssize_t>(0, count));
  }
  return true;
}

void TevDisplay::give_up(const std::string& problem) {
  if (socket_ >= 0) close(socket_);
  socket_ = -1;
  queue_.abandon();
  if (end_s_ != 0)  // else all is over, and nobody looks
    tell_(fmt::format("--display {}: the viewer {}; the job goes on without it", name_, problem));
}

bool TevDisplay::send_frame(const SeenSubpolygon& subpolygon) {
  if (std::find(shown_.begin(), shown_.end(), subpolygon.frame) != shown_.end()) return true;
  const PixelRect& window = job_.image.window;
  const auto& channels = job_.image.layout.channels;
  PacketWriter create(TevPacket::create_image);
  create.flag(shown_.empty()).text(job_.files[subpolygon.frame.place()]);
  create.i32(window.width()).i32(window.height()).i32(static_cast<int>(channels.size()));
  for (const PixelChannel& channel : channels) create.text(channel.name);
  if (!send_packet(create.take())) return false;
  shown_.push_back(subpolygon.frame);
  if (shown_.size() <= kMostFrames) return true;
  PacketWriter close_image(TevPacket::close_image);
  close_image.text(job_.files[shown_.front().place()]);
  shown_.pop_front();
  return send_packet(close_image.take());
}

bool TevDisplay::send_subpolygon(const SeenSubpolygon& subpolygon) {
  const PixelLayout& layout = job_.image.layout;
  const DisplayPolygon& p = subpolygon.polygon;
  const int width = p.right - p.left + 1, height = p.bottom - p.top + 1;
  PacketWriter update(TevPacket::update_image_v3);
  update.flag(false).text(job_.files[subpolygon.frame.place()]).i32(static_cast<int>(layout.channels.size()));
  for (const PixelChannel& channel : layout.channels) update.text(channel.name);
  update.i32(p.left - job_.image.window.x0).i32(p.top - job_.image.window.y0).i32(width).i32(height);
  for (size_t c = 0; c < layout.channels.size(); ++c) update.i64(c);
  for (size_t c = 0; c < layout.channels.size(); ++c) update.i64(layout.channels.size());
  for (size_t at = 0; at < subpolygon.pixels.size(); at += layout.bytes)
    for (const PixelChannel& channel : layout.channels)
      update.f32(static_cast<float>(decode_value(channel, subpolygon.pixels.data() + at)));
  return send_packet(update.take());
}

}  // namespace rayfarm
