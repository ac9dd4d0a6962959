#include "node/node.h"

#include <fmt/core.h>
#include <unistd.h>

#include <cstdio>
#include <deque>
#include <thread>
#include <utility>

#include "protocol/block_codec.h"
#include "protocol/build_identity.h"
#include "protocol/clock.h"
#include "protocol/watchdog.h"

namespace rayfarm {
namespace {

static_assert(kRayCounters == kRayKinds, "the wire carries a counter for each kind of ray");

constexpr double kPollInterval_s = 0.01;  ///< while tracing

/// The host said that the job is over.
struct Finished {
  bool has_losses = false;
};
/// The host is gone, or has been silent for too long.
struct HostGone {
  std::string sign;
};

struct Assigned {
  int frame = 0;
  DisplayPolygon polygon;
};

class Node {
 public:
  Node(Transport& transport, int self) : transport_(transport), self_(self) {}

  void introduce() {
    transport_.send(kHost, Hello{machine_name(), static_cast<uint32_t>(getpid()), build_identity()});
  }

  /// Waits for load code.
  JobPlan receive_plan() {
    for (Backoff backoff; !plan_bytes_; backoff.wait()) poll();
    return decode_plan(*plan_bytes_);
  }

  void begin(const JobPlan& plan) {
    plan_ = plan;
    host_heard_ = listening_.now();
  }

  /// Until the host ends it. A node that could not load (no tracer) only waits for that.
  [[noreturn]] void work(SubpolygonTracer* tracer) {
    Backoff backoff;
    while (true) {
      poll();
      if (const auto next = tracer ? next_subpolygon() : std::nullopt) {
        trace(*tracer, *next);
        backoff.reset();
      } else {
        backoff.wait();
      }
    }
  }

  const ProcessSign& host() const { return host_; }

  void send_failure(const std::string& problem) { transport_.send(kHost, NodeFailed{problem}); }

 private:
  /// Takes up all messages, and judges the host's silence.
  void poll() {
    last_poll_ = now_s();
    listening_.turn(last_poll_);
    while (auto message = transport_.try_receive()) {
      host_heard_ = listening_.now();
      if (message->channel == Channel::control) {
        receive_control(decode_control(message->bytes));
      } else if (command_of(message->bytes) == Command::load_code) {
        plan_bytes_ = decode_load_code(message->bytes);
      } else {
        assigned_.push_back({frame_, decode_display_polygon(message->bytes)});
      }
    }
    if (!transport_.is_one_process()) doubt_host();
  }

  /// Silence alone ends nothing soon: a host that was stopped may go on.
  void doubt_host() {
    const double silence = listening_.now() - host_heard_;
    if (silence < liveness::kHostDoubt_s) return;
    const std::string host =
        host_.pid() ? fmt::format("its host (process {} on {})", host_.pid(), host_.machine()) : "its host";
    if (host_.is_gone()) throw HostGone{host + " is gone"};
    if (silence > plan_.host_timeout_s)
      throw HostGone{fmt::format("{} has been silent for {:.0f} s", host, silence)};
  }

  void receive_control(const Control& control) {
    if (const auto* finish = std::get_if<Finish>(&control)) throw Finished{finish->has_losses};
    if (std::holds_alternative<AskPresent>(control)) transport_.send(kHost, Present{});
    if (const auto* hello = std::get_if<Hello>(&control)) host_ = {hello->machine, hello->pid};
    if (const auto* select = std::get_if<SelectFrame>(&control)) frame_ = static_cast<int>(select->frame);
    if (const auto* window = std::get_if<OpenWindow>(&control)) window_end_ = window->end_index;
    if (const auto* end = std::get_if<EndProcess>(&control)) end_hung_process(end->pid);
  }

  /// What the host assigned comes first; then, when interleaved, this node's own set of each frame in the
  /// window.
  std::optional<Assigned> next_subpolygon() {
    if (!assigned_.empty()) {
      const Assigned next = assigned_.front();
      assigned_.pop_front();
      return next;
    }
    if (plan_.policy != AssignmentPolicy::interleaved) return std::nullopt;
    while (own_next_ == own_.size()) {
      if (own_frame_index_ >= window_end_ || own_frame_index_ >= plan_.frames.size()) return std::nullopt;
      own_ = interleaved_set(plan_.grid, plan_.processors,
                             plan_.rotates ? static_cast<int>(own_frame_index_) : 0, self_ - 1);
      ++own_frame_index_;
      own_next_ = 0;
    }
    return Assigned{plan_.frames[own_frame_index_ - 1], plan_.grid.polygon(own_[own_next_++])};
  }

  void trace(SubpolygonTracer& tracer, const Assigned& work) {
    const int subpolygon = plan_.grid.find(work.polygon);
    const double begin = now_s();
    try {
      if (subpolygon < 0) throw ProtocolError("the display polygon is not one of the grid's");
      const auto traced = tracer.trace(work.frame, work.polygon, [this] {
        if (now_s() - last_poll_ > kPollInterval_s) poll();
      });
      if (plan_.ray_time_s > 0) pretend_until(begin + emulated_s(traced.rays));
      SubpolygonReport report{static_cast<uint32_t>(work.frame),
                              static_cast<uint32_t>(subpolygon),
                              traced.rays.by_kind,
                              static_cast<uint64_t>((now_s() - begin) * 1e6),
                              traced.sees_anything,
                              traced.not_finite};
      if (plan_.wire == Wire::pixel)
        send_pixels(work.polygon, report, traced.pixels);
      else
        send_block(work.polygon, report, traced.pixels);
    } catch (const std::exception& e) {
      transport_.send(kHost, SubpolygonFailed{static_cast<uint32_t>(work.frame),
                                              static_cast<uint32_t>(std::max(subpolygon, 0)), e.what()});
    }
  }

  /// What the emulated processor takes for so many rays.
  double emulated_s(const RayCounts& rays) const {
    const auto& factors = plan_.time_factors;
    const double factor = factors.empty() ? 1 : factors[static_cast<size_t>(self_ - 1) % factors.size()];
    return plan_.ray_time_s * factor * static_cast<double>(rays.total());
  }

  /// Lets time pass as an emulated processor's, without using this one.
  void pretend_until(double end) {
    for (double rest; (rest = end - now_s()) > 0;) {
      std::this_thread::sleep_for(std::chrono::duration<double>(std::min(rest, kPollInterval_s)));
      if (now_s() - last_poll_ > kPollInterval_s) poll();
    }
  }

  uint16_t processor() const { return static_cast<uint16_t>(self_ - 1); }

  void send_pixels(const DisplayPolygon& polygon, const SubpolygonReport& report, const Bytes& pixels) {
    ByteWriter writer;
    size_t i = 0;
    for (int y = polygon.top; y <= polygon.bottom; ++y)
      for (int x = polygon.left; x <= polygon.right; ++x, i += 3) {
        append_pixel(processor(),
                     {static_cast<uint16_t>(x),
                      static_cast<uint16_t>(y),
                      {static_cast<uint8_t>(pixels[i]), static_cast<uint8_t>(pixels[i + 1]),
                       static_cast<uint8_t>(pixels[i + 2])}},
                     writer);
        if (writer.size() == kPixelsPerTransfer * kPixelBytes)
          transport_.send(kHost, Channel::pixels, std::exchange(writer, {}).take());
      }
    if (writer.size() > 0) transport_.send(kHost, Channel::pixels, writer.take());
    transport_.send(kHost, SubpolygonDone{report});
  }

  void send_block(const DisplayPolygon& polygon, const SubpolygonReport& report, const Bytes& pixels) {
    const int width = polygon.right - polygon.left + 1, height = polygon.bottom - polygon.top + 1;
    BlockResult block{report, false, pixels};
    Bytes compressed;
    if (plan_.compresses) {
      compressed = compress_rgb8(pixels, width, height);
      if (compressed.size() < pixels.size()) {
        block.is_compressed = true;
        block.pixels = compressed;
      }
    }
    transport_.send(kHost, Channel::command, encode_block(processor(), block));
  }

  Transport& transport_;
  int self_;
  JobPlan plan_;
  std::optional<Bytes> plan_bytes_;
  ProcessSign host_;
  ListeningClock listening_;
  double host_heard_ = 0;  ///< by the listening clock
  double last_poll_ = 0;
  int frame_ = 0;  ///< of the display polygons to come
  std::deque<Assigned> assigned_;
  uint32_t window_end_ = 0;     ///< interleaved: frames of the sequence before this may be traced
  size_t own_frame_index_ = 0;  ///< interleaved: the next frame of the sequence
  std::vector<int> own_;
  size_t own_next_ = 0;
};

}  // namespace

NodeEnding run_node(Transport& transport, int self, const LoadScene& load_scene,
                    const MakeTracer& make_tracer) {
  Node node(transport, self);
  try {
    node.introduce();
    const JobPlan plan = node.receive_plan();
    if (plan.build != build_identity()) {
      std::fprintf(stderr, "rayfarm: node %d on %s is of another build than its host; it refuses to work\n",
                   self, machine_name().c_str());
      return NodeEnding::failed;
    }
    std::unique_ptr<SubpolygonTracer> tracer;
    try {
      tracer = make_tracer(plan, load_scene(node.host()));
    } catch (const std::exception& e) {
      node.send_failure(e.what());
    }
    node.begin(plan);
    node.work(tracer.get());
  } catch (const Finished& finished) {
    return finished.has_losses ? NodeEnding::finished_with_losses : NodeEnding::finished;
  } catch (const HostGone& gone) {
    std::fprintf(stderr, "rayfarm: node %d on %s ends: %s\n", self, machine_name().c_str(),
                 gone.sign.c_str());
    return NodeEnding::failed;
  }
}

}  // namespace rayfarm
