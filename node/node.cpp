#include "node/node.h"

#include <fmt/core.h>
#include <unistd.h>

#include <cstdio>
#include <deque>
#include <thread>
#include <utility>
#include <variant>

#include "node/results.h"
#include "protocol/build_identity.h"
#include "protocol/clock.h"
#include "protocol/phase_data.h"
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

/// The host began another phase while an item was done, which nobody needs any more.
struct PhaseOver {};

/// What the host hands out.
struct PolygonOfStep {
  StepIndex step;
  DisplayPolygon polygon;
  Bytes running;  ///< of the pass before
};
using Assigned = std::variant<PolygonOfStep, UnitRange>;

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
    transport_.set_beat_s(plan.beat_s);
    host_heard_ = listening_.now();
  }

  using MakeZones = std::function<std::unique_ptr<ZoneTracer>(FrameNumber frame)>;

  /// Until the host ends it. A node that could not load (no worker for pictures) only waits for that.
  [[noreturn]] void work(PictureWorker* pictures, const MakeZones& make_zones) {
    pictures_ = pictures;
    make_zones_ = make_zones;
    Backoff backoff;
    while (true) {
      poll();
      if (const auto next = pictures_ ? next_item() : std::nullopt) {
        do_item(*next);
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
    if (next_phase_) begin_phase(*std::exchange(next_phase_, std::nullopt));
    while (auto message = transport_.try_receive()) {
      host_heard_ = listening_.now();
      if (message->channel == Channel::control)
        receive_control(decode_control(message->bytes));
      else
        receive_command(message->bytes);
    }
    if (!transport_.is_one_process()) doubt_host();
  }

  void receive_command(std::span<const std::byte> message) {
    switch (command_of(message)) {
      case Command::load_code:
        plan_bytes_ = decode_load_code(message);
        break;
      case Command::load_data:
        data().take(decode_load_data(message));
        break;
      default:
        if (is_of_zones())
          assigned_.emplace_back(decode_unit_range(message));
        else
          assigned_.emplace_back(
              PolygonOfStep{step_, decode_display_polygon(message), std::exchange(running_, {})});
    }
  }

  bool is_of_zones() const { return begin_.kind == PhaseKind::zones; }
  /// Of the phase at work. A picture's worker may look at the last solution while stages go on.
  DataIntake& data() { return is_of_zones() ? stage_ : solution_; }

  /// Not while an item is done.
  void begin_phase(const BeginPhase& begin) {
    begin_ = begin;
    phase_.reset();
    is_prepared_ = false;
    assigned_.clear();
    running_.clear();
    step_ = open_end_ = own_step_ = StepIndex();
    next_own_ = 0;
    if (!is_of_zones() || tracer_frame_ != begin.frame) tracer_.reset();
    stage_.expect(kStageAddress, 0);
    try {
      data().expect(is_of_zones() ? kStageAddress : kSolutionAddress, begin.data_bytes);
    } catch (const std::bad_alloc&) {
      send_failure(fmt::format("there is no memory for {} MiB of zones", begin.data_bytes >> 20));
      pictures_ = nullptr;
    }
  }

  /// Silence alone ends nothing soon: a host that was stopped may go on.
  void doubt_host() {
    const double silence = listening_.now() - host_heard_;
    if (silence < liveness::kHostDoubtBeats * transport_.beat_s()) return;
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
    if (const auto* go_on = std::get_if<GoOnFrom>(&control)) running_ = go_on->running;
    if (const auto* open = std::get_if<OpenSteps>(&control)) open_end_ = open->end;
    if (const auto* end = std::get_if<EndProcess>(&control)) end_hung_process(end->pid);
    if (const auto* begin = std::get_if<BeginPhase>(&control)) {
      if (is_working_) {
        next_phase_ = *begin;
        throw PhaseOver{};
      }
      begin_phase(*begin);
    }
  }

  /// What the host assigned comes first; then, when interleaved, this node's own items of each open step.
  std::optional<Assigned> next_item() {
    if (begin_.units == 0 || !data().is_whole()) return std::nullopt;
    if (!phase_) phase_ = phase_of(*plan_, begin_);
    if (!assigned_.empty()) {
      Assigned next = std::move(assigned_.front());
      assigned_.pop_front();
      return next;
    }
    if (plan_->policy != AssignmentPolicy::interleaved) return std::nullopt;
    return std::visit([this](const auto& phase) { return next_own(phase); }, *phase_);
  }

  std::optional<Assigned> next_own(const PicturesPhase& phase) {
    if (!own_set_)
      own_set_ = interleaved_set(phase.grid, plan_->sets, plan_->processors, processor_of(self_));
    if (own_set_->empty()) return std::nullopt;
    if (next_own_ == own_set_->size()) {
      ++own_step_;
      next_own_ = 0;
    }
    if (own_step_ >= open_end_ || own_step_.value() >= phase.steps()) return std::nullopt;
    const SubpolygonId own = own_subpolygon(*plan_, phase, own_step_, (*own_set_)[next_own_++]);
    return PolygonOfStep{own_step_, phase.grid.polygon(own), {}};
  }

  std::optional<Assigned> next_own(const ZonePhase& phase) {
    if (open_end_ == StepIndex()) return std::nullopt;
    // One in every so many items, from that on which is ours.
    ItemIndex item(static_cast<int64_t>(next_own_) * plan_->processors);
    while (zone_owner(begin_.number, plan_->processors, item) != self_) ++item;
    if (!phase.has(item)) return std::nullopt;
    ++next_own_;
    return phase.units_of(item);
  }

  void do_item(const Assigned& assigned) {
    ItemIndex item;  // what a failure tells of; wrong ones name the first
    is_working_ = true;
    try {
      if (const auto* polygon = std::get_if<PolygonOfStep>(&assigned))
        trace(std::get<PicturesPhase>(*phase_), *polygon, item);
      else
        spread(std::get<ZonePhase>(*phase_), std::get<UnitRange>(assigned), item);
    } catch (const PhaseOver&) {
    } catch (const std::exception& e) {
      transport_.send(kHost, ItemFailed{begin_.number, item, e.what()});
    }
    is_working_ = false;
  }

  /// Traces a subpolygon, and returns it.
  void trace(const PicturesPhase& phase, const PolygonOfStep& assigned, ItemIndex& item) {
    const double begin = now_s();
    item = phase.item_of(assigned.step, SubpolygonId());
    const std::optional<SubpolygonId> subpolygon = phase.grid.find(assigned.polygon);
    if (!subpolygon) throw ProtocolError("the display polygon is not one of the grid's");
    item = phase.item_of(assigned.step, *subpolygon);
    if (!phase.has(item)) throw ProtocolError("the step is not one of the phase's");
    if (begin_.data_bytes > 0 && !is_prepared_) pictures_->set_zones(data().bytes());
    is_prepared_ = true;
    const int pass = phase.pass_of(assigned.step);
    const ItemResult result =
        pictures_->work(phase.number_of(item), assigned.polygon,
                        {static_cast<uint32_t>(pass), static_cast<uint32_t>(phase.passes), assigned.running},
                        [this] { pulse(); });
    if (plan_->ray_time_s > 0) pretend_until(begin + emulated_s(result.rays));
    const SubpolygonReport report{phase.number_of(item), *subpolygon,
                                  result.rays.by_kind,   static_cast<uint64_t>((now_s() - begin) * 1e6),
                                  result.sees_anything,  result.not_finite,
                                  result.rays.tallies};
    send_subpolygon(transport_, self_, *plan_, assigned.polygon, report, static_cast<uint16_t>(pass), result);
  }

  /// Does an item of a stage of zones, and returns what came of it.
  void spread(const ZonePhase& phase, const UnitRange& range, ItemIndex& item) {
    const double begin = now_s();
    const std::optional<ItemIndex> found = phase.find(range);
    if (!found) throw ProtocolError("the units are not an item's");
    item = *found;
    if (!tracer_) {
      tracer_ = make_zones_(phase.frame);
      tracer_frame_ = phase.frame.value();
    }
    if (!is_prepared_) tracer_->begin(data().bytes());
    is_prepared_ = true;
    const ZoneItemResult result =
        tracer_->work(range.first, uint64_t{range.last} - range.first + 1, [this] { pulse(); });
    if (plan_->ray_time_s > 0) pretend_until(begin + emulated_s(result.rays));
    send_zones(transport_, self_,
               {begin_.number,
                item,
                result.rays.by_kind,
                static_cast<uint64_t>((now_s() - begin) * 1e6),
                result.rays.tallies,
                false,
                {}},
               result.bytes);
  }

  /// To be called often while an item is done.
  void pulse() {
    if (now_s() - last_poll_ > liveness::kPoll_s) poll();
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
      pulse();
    }
  }

  Transport& transport_;
  NodeId self_;
  const JobPlan* plan_ = nullptr;  ///< once it has loaded
  PictureWorker* pictures_ = nullptr;
  MakeZones make_zones_;
  std::optional<Bytes> plan_bytes_;
  ProcessSign host_;
  ListeningClock listening_;
  double host_heard_ = 0;  ///< by the listening clock
  double last_poll_ = 0;

  BeginPhase begin_;                      ///< of the phase at work; without units: none is yet
  std::optional<BeginPhase> next_phase_;  ///< came while an item was done
  std::optional<Phase> phase_;            ///< the phase at work, once there is something to do
  DataIntake stage_, solution_;
  bool is_prepared_ = false;  ///< the worker has the phase's data
  bool is_working_ = false;   ///< an item is being done
  std::unique_ptr<ZoneTracer> tracer_;
  int tracer_frame_ = 0;
  StepIndex step_;  ///< of the display polygons to come
  Bytes running_;   ///< of the pass before, for the next of them
  std::deque<Assigned> assigned_;
  StepIndex open_end_;  ///< interleaved: steps before this may be worked on
  StepIndex own_step_;  ///< interleaved: at whose items the node is
  /// Interleaved: the node's own subpolygons of the first frame, once they are needed.
  std::optional<std::vector<SubpolygonId>> own_set_;
  size_t next_own_ = 0;  ///< of the step
};

}  // namespace

NodeEnding run_node(Transport& transport, NodeId self, const LoadScene& load_scene, const Workers& workers) {
  Node node(transport, self);
  try {
    node.introduce();
    const JobPlan plan = node.receive_plan();
    if (plan.build != build_identity()) {
      std::fprintf(stderr, "rayfarm: node %d on %s is of another build than its host; it refuses to work\n",
                   self.value(), machine_name().c_str());
      return NodeEnding::failed;
    }
    std::span<const std::byte> scene;
    std::unique_ptr<PictureWorker> pictures;
    try {
      scene = load_scene(node.host());
      pictures = workers.make_pictures(plan, scene);
    } catch (const std::exception& e) {
      node.send_failure(e.what());
    }
    node.begin(plan);
    node.work(pictures.get(), [&](FrameNumber frame) { return workers.make_zones(plan, scene, frame); });
  } catch (const Finished& finished) {
    return finished.has_losses ? NodeEnding::finished_with_losses : NodeEnding::finished;
  } catch (const HostGone& gone) {
    std::fprintf(stderr, "rayfarm: node %d on %s ends: %s\n", self.value(), machine_name().c_str(),
                 gone.sign.c_str());
    return NodeEnding::failed;
  }
}

}  // namespace rayfarm
