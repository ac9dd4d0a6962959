#include "node/node.h"

#include <fmt/core.h>
#include <unistd.h>

#include <cstdio>
#include <deque>
#include <thread>
#include <utility>

#include "node/results.h"
#include "protocol/build_identity.h"
#include "protocol/clock.h"
#include "protocol/watchdog.h"

namespace rayfarm {
namespace {

static_assert(kRayCounters == kRayKinds && kRayTallyCounters == kRayTallies,
              "the wire carries a counter for each kind of ray, and for all else that is counted");

/// The host said that the job is over.
struct Finished {
  bool has_losses = false;
};
/// The host is gone, or has been silent for too long.
struct HostGone {
  std::string sign;
};

/// What the host hands out.
struct Assigned {
  StepIndex step;
  DisplayPolygon polygon;
};

class Node {
 public:
  Node(Transport& transport, NodeId self) : transport_(transport), self_(self) {}

  void introduce() {
    transport_.send(kHost, Hello{machine_name(), static_cast<uint32_t>(getpid()), build_identity()});
  }

  /// Waits for load code.
  JobPlan receive_plan() {
    for (Backoff backoff; !plan_bytes_; backoff.wait_for(transport_)) poll();
    return decode_plan(*plan_bytes_);
  }

  /// From now on the node works by `plan`, which must outlive it.
  void begin(const JobPlan& plan) {
    plan_ = &plan;
    phase_ = &pictures_of(plan);
    host_heard_ = listening_.now();
  }

  /// Until the host ends it. A node that could not load (no worker) only waits for that.
  [[noreturn]] void work(PhaseWorker* worker) {
    Backoff backoff;
    while (true) {
      poll();
      if (const auto next = worker ? next_item() : std::nullopt) {
        do_item(*worker, *next);
        backoff.reset();
      } else {
        backoff.wait_for(transport_);
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
        assigned_.push_back({step_, decode_display_polygon(message->bytes)});
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
    if (silence > host_timeout_s())
      throw HostGone{fmt::format("{} has been silent for {:.0f} s", host, silence)};
  }

  double host_timeout_s() const { return plan_ ? plan_->host_timeout_s : liveness::kLongSilence_s; }

  void receive_control(const Control& control) {
    if (const auto* finish = std::get_if<Finish>(&control)) throw Finished{finish->has_losses};
    if (std::holds_alternative<AskPresent>(control)) transport_.send(kHost, Present{});
    if (const auto* hello = std::get_if<Hello>(&control)) host_ = {hello->machine, hello->pid};
    if (const auto* select = std::get_if<SelectStep>(&control)) step_ = select->step;
    if (const auto* open = std::get_if<OpenSteps>(&control)) open_end_ = open->end;
    if (const auto* end = std::get_if<EndProcess>(&control)) end_hung_process(end->pid);
  }

  /// What the host assigned comes first; then, when interleaved, this node's own items of each open step.
  std::optional<Assigned> next_item() {
    if (!assigned_.empty()) {
      const Assigned next = assigned_.front();
      assigned_.pop_front();
      return next;
    }
    if (plan_->policy != AssignmentPolicy::interleaved) return std::nullopt;
    if (!own_set_)
      own_set_ = interleaved_set(phase_->grid, plan_->sets, plan_->processors, processor_of(self_));
    if (own_set_->empty()) return std::nullopt;
    if (next_of_set_ == own_set_->size()) {
      ++own_step_;
      next_of_set_ = 0;
    }
    if (own_step_ >= open_end_ || own_step_.value() >= phase_->steps()) return std::nullopt;
    const SubpolygonId own = own_subpolygon(*plan_, *phase_, own_step_, (*own_set_)[next_of_set_++]);
    return Assigned{own_step_, phase_->grid.polygon(own)};
  }

  void do_item(PhaseWorker& worker, const Assigned& assigned) {
    const double begin = now_s();
    ItemIndex item = phase_->item_of(assigned.step, SubpolygonId());
    try {
      const std::optional<SubpolygonId> subpolygon = phase_->grid.find(assigned.polygon);
      if (!subpolygon) throw ProtocolError("the display polygon is not one of the grid's");
      item = phase_->item_of(assigned.step, *subpolygon);
      if (!phase_->has(item)) throw ProtocolError("the step is not one of the phase's");
      const ItemResult result = worker.work(item, [this] {
        if (now_s() - last_poll_ > liveness::kPoll_s) poll();
      });
      if (plan_->ray_time_s > 0) pretend_until(begin + emulated_s(result.rays));
      const SubpolygonReport report{phase_->number_of(item), *subpolygon,
                                    result.rays.by_kind,     static_cast<uint64_t>((now_s() - begin) * 1e6),
                                    result.sees_anything,    result.not_finite,
                                    result.rays.tallies};
      send_subpolygon(transport_, self_, *plan_, assigned.polygon, report, result.bytes);
    } catch (const std::exception& e) {
      transport_.send(kHost, ItemFailed{item, e.what()});
    }
  }

  /// What the emulated processor takes for so many rays.
  double emulated_s(const RayCounts& rays) const {
    const auto& factors = plan_->time_factors;
    const double factor = factors.empty() ? 1 : factors[(self_.place() - 1) % factors.size()];
    return plan_->ray_time_s * factor * static_cast<double>(rays.total());
  }

  /// Lets time pass as an emulated processor's, without using this one.
  void pretend_until(double end) {
    for (double rest; (rest = end - now_s()) > 0;) {
      std::this_thread::sleep_for(std::chrono::duration<double>(std::min(rest, liveness::kPoll_s)));
      if (now_s() - last_poll_ > liveness::kPoll_s) poll();
    }
  }

  Transport& transport_;
  NodeId self_;
  const JobPlan* plan_ = nullptr;  ///< once it has loaded
  const PicturesPhase* phase_ = nullptr;
  std::optional<Bytes> plan_bytes_;
  ProcessSign host_;
  ListeningClock listening_;
  double host_heard_ = 0;  ///< by the listening clock
  double last_poll_ = 0;
  StepIndex step_;  ///< of the display polygons to come
  std::deque<Assigned> assigned_;
  StepIndex open_end_;  ///< interleaved: steps before this may be worked on
  StepIndex own_step_;  ///< interleaved: at whose items the node is
  /// Interleaved: the node's own subpolygons of the first frame, once they are needed.
  std::optional<std::vector<SubpolygonId>> own_set_;
  size_t next_of_set_ = 0;
};

}  // namespace

NodeEnding run_node(Transport& transport, NodeId self, const LoadScene& load_scene,
                    const MakeWorker& make_worker) {
  Node node(transport, self);
  try {
    node.introduce();
    const JobPlan plan = node.receive_plan();
    if (plan.build != build_identity()) {
      std::fprintf(stderr, "rayfarm: node %d on %s is of another build than its host; it refuses to work\n",
                   self.value(), machine_name().c_str());
      return NodeEnding::failed;
    }
    std::unique_ptr<PhaseWorker> worker;
    try {
      worker = make_worker(plan, plan.phases.at(0), load_scene(node.host()));
    } catch (const std::exception& e) {
      node.send_failure(e.what());
    }
    node.begin(plan);
    node.work(worker.get());
  } catch (const Finished& finished) {
    return finished.has_losses ? NodeEnding::finished_with_losses : NodeEnding::finished;
  } catch (const HostGone& gone) {
    std::fprintf(stderr, "rayfarm: node %d on %s ends: %s\n", self.value(), machine_name().c_str(),
                 gone.sign.c_str());
    return NodeEnding::failed;
  }
}

}  // namespace rayfarm
