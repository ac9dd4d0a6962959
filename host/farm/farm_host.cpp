#include "host/farm/farm_host.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "host/farm/report.h"
#include "host/farm/watching.h"
#include "host/process/interrupt.h"
#include "protocol/clock.h"

namespace rayfarm {
namespace {

AssignmentOptions assignment_options(const FarmHostOptions& o) {
  AssignmentOptions a;
  a.nodes = o.plan.processors;
  a.steps = 0;  // the first phase brings its own
  a.lost_after_s = o.signs.empty() ? std::numeric_limits<double>::infinity() : o.node_timeout_s;
  return a;
}

/// Of all frames, once for each pass.
uint64_t pixels_of(const FarmHostOptions& o) {
  return static_cast<uint64_t>(o.image.window.area()) * static_cast<uint64_t>(o.plan.pictures.steps());
}

}  // namespace

FarmHost::FarmHost(Transport& transport, const FarmHostOptions& options, JobResult& result, Tell tell)
    : transport_(transport),
      options_(options),
      result_(result),
      tell_(std::move(tell)),
      assignment_(assignment_options(options), listening_.turn(now_s())),
      pictures_(transport, options, result, tell_, assignment_),
      zones_(transport, options.plan, result, assignment_),
      progress_(options.progress, pixels_of(options)) {
  for (size_t i = 0; i < options_.signs.size(); ++i)
    if (options_.signs[i].tells()) watched_.emplace_back(static_cast<int>(i) + 1);
  for (Watcher* const watcher : options_.watchers) watcher->begin({options_.image, options_.files});
}

void FarmHost::run() {
  const double begin = now_s(), cpu_begin = cpu_s();
  result_.times.trace_began_unix_s = unix_s();
  std::vector<FrameGroup> groups = options_.groups;
  if (groups.empty()) groups = {{FrameIndex(0), static_cast<int>(options_.plan.pictures.frames.size())}};
  for (const FrameGroup& group : groups) {
    std::optional<Bytes> solution = options_.zones.make_solver ? solve_zones(group) : Bytes();
    if (!solution) break;
    if (options_.zones.take) {
      options_.zones.take(options_.plan.pictures.frames[group.first.place()], std::move(*solution));
      continue;
    }
    make_pictures(group, std::move(*solution));
    if (is_over_) break;
  }
  watchers_told_s_ = 0;
  tell_watchers(FarmStage::writing, now_s());
  pictures_.finish(listening_.now(), result_.was_interrupted);
  result_.times.host_cpu_s = cpu_s() - cpu_begin;
  result_.times.finish_s = now_s() - begin - result_.times.trace_s - result_.zones.seconds;
  show_progress(true);
  progress_.clear();
  watchers_told_s_ = 0;
  tell_watchers(FarmStage::writing, now_s());
}

std::optional<Bytes> FarmHost::solve_zones(const FrameGroup& group) {
  const FrameNumber frame = options_.plan.pictures.frames[group.first.place()];
  const double begin = now_s();
  std::optional<Bytes> solution;
  try {
    if (options_.zones.find) solution = options_.zones.find(frame);
    if (solution) {
      ++result_.zones.read;
    } else {
      const auto solver = options_.zones.make_solver(frame);
      solution = spread(*solver, frame);
      if (!is_over_ && options_.zones.keep) options_.zones.keep(frame, *solution);
    }
    if (solution->size() > kMostPhaseDataBytes)
      throw std::runtime_error("the light of all zones is more than the net addresses (32 GiB)");
  } catch (const std::bad_alloc&) {
    result_.problem = fmt::format("zones of frame {}: the host has no memory for them", frame.value());
  } catch (const std::exception& e) {
    result_.problem = fmt::format("zones of frame {}: {}", frame.value(), e.what());
  }
  zones_.end();
  result_.zones.seconds += now_s() - begin;
  is_over_ |= !result_.problem.empty();
  return is_over_ ? std::nullopt : std::move(solution);
}

Bytes FarmHost::spread(ZoneSolver& solver, FrameNumber frame) {
  const int rounds_before = result_.zones.rounds;
  while (std::optional<ZoneStage> stage = solver.next_stage()) {
    if (stage->units == 0) continue;  // a scene without surfaces has no zones
    zones_.begin(*stage, frame, next_number_, solver);
    run_phase(zones_, kStageAddress, std::move(stage->data));
    result_.zones.rounds = rounds_before + solver.progress().rounds;
    if (is_over_) return {};
  }
  result_.zones.rounds = rounds_before + solver.progress().rounds;
  zones_.end();
  return solver.solution();
}

void FarmHost::make_pictures(const FrameGroup& group, Bytes solution) {
  result_.zones.data_bytes += solution.size();
  const double begin = now_s();
  traced_s_ = begin;
  pictures_.begin(group);
  run_phase(pictures_, kSolutionAddress, std::move(solution));
  pictures_.end();
  result_.times.trace_s += (traced_s_ > begin ? traced_s_ : now_s()) - begin;
}

void FarmHost::run_phase(PhaseHost& phase, uint64_t address, Bytes data) {
  const BeginPhase beginning = beginning_of(phase.phase(), next_number_++, data.size());
  transport_.broadcast(Channel::control, encode_control(beginning));
  feed_.emplace(transport_, address, std::move(data));
  for (const NodeResult& node : result_.nodes)
    if (assignment_.is_expelled(node.id)) feed_->leave_out(node.id);
  phase_ = &phase;
  phase_began_s_ = now_s();
  assignment_.begin(phase.work(), listening_.turn(phase_began_s_));
  Backoff backoff;
  while (!assignment_.is_over() && !is_over_) {
    const double now = listening_.turn(now_s());
    const bool has_fed = feed_->turn(), has_come = take_messages(now) | take_blocks(now);
    expel_the_gone(now);
    if (now - ticked_s_ > liveness::kTick_s) {
      assignment_.tick(now);
      ticked_s_ = now;
    }
    pictures_.take_written(now);
    for (const Action& action : assignment_.take_actions()) carry_out(action);
    is_over_ |= !result_.problem.empty();
    tell_if_none_is_heard();
    if (interrupted_by() != 0) {
      result_.was_interrupted = true;
      is_over_ = true;
    }
    show_progress(false);
    tell_watchers(zones_.is_at_work() ? FarmStage::zones : FarmStage::pictures, now_s());
    const bool is_busy = has_fed || has_come;
    if (is_busy || pictures_.has_blocks()) backoff.reset();  // these will not take long
    if (!is_busy) backoff.wait_for(transport_);
  }
  // What has come is kept in journals, if not in pictures.
  for (Backoff nap; pictures_.has_blocks(); nap.wait()) take_blocks(listening_.now());
}

/// False: none had come.
bool FarmHost::take_messages(double now) {
  // A bounded number of messages a turn: whatever comes in, time-outs and signals are looked at too.
  constexpr int kMost = 1000;
  int taken = 0;
  for (; taken < kMost; ++taken) {
    auto message = transport_.try_receive();
    if (!message) break;
    const uint64_t before = result_.pixels_received;
    receive(std::move(*message), now);
    if (result_.pixels_received != before) traced_s_ = now_s();  // tracing ends with the last result
  }
  return taken > 0;
}

/// False: none was decompressed.
bool FarmHost::take_blocks(double now) {
  bool has_come = false;
  while (const auto block = pictures_.take_block()) {
    has_come = true;
    try {
      pictures_.keep_block(*block, now);
    } catch (const ProtocolError& e) {
      expel(block->node, fmt::format("sent what can't be understood ({})", e.what()), now);
    }
    traced_s_ = now_s();
  }
  return has_come;
}

void FarmHost::receive(Message message, double now) {
  const NodeId node = message.source;
  try {
    switch (message.channel) {
      case Channel::control:
        receive_control(node, decode_control(message.bytes), now);
        break;
      case Channel::pixels:
        pictures_.receive_pixels(node, message.bytes);
        break;
      case Channel::command:
        if (is_zone_result(message.bytes))
          zones_.receive(node, message.bytes, now);
        else
          pictures_.receive_block(node, std::move(message.bytes), now);
        break;
    }
    assignment_.hear(node, now);
  } catch (const ProtocolError& e) {
    expel(node, fmt::format("sent what can't be understood ({})", e.what()), now);
  }
}

void FarmHost::expel(NodeId node, const std::string& problem, double now) {
  NodeResult& result = result_.node(node);
  if (!result.problem.empty()) return;
  result.problem = problem;
  if (result.is_lost) tell_(fmt::format("node {} {}; it stays lost", node.value(), problem));
  assignment_.expel(node, now);
  feed_->leave_out(node);
}

/// Looks at each within kLook_s, a few a turn: a look at the process table takes as long as a message.
void FarmHost::expel_the_gone(double now) {
  if (watched_.empty()) return;
  const double step_s = liveness::kLook_s / static_cast<double>(watched_.size());
  looked_s_ = std::max(looked_s_, now - liveness::kLook_s);  // each once, after a long turn
  for (; looked_s_ + step_s <= now; looked_s_ += step_s) {
    next_watched_ = (next_watched_ + 1) % watched_.size();
    const NodeId node = watched_[next_watched_];
    if (options_.signs[node.place() - 1].is_gone()) expel(node, "its process is gone", now);
  }
}

void FarmHost::receive_control(NodeId node, const Control& control, double now) {
  if (const auto* done = std::get_if<SubpolygonDone>(&control)) {
    pictures_.end_of_pixels(node, done->report, now);
  } else if (const auto* failed = std::get_if<ItemFailed>(&control)) {
    receive_failure(node, *failed, now);
  } else if (const auto* broken = std::get_if<NodeFailed>(&control)) {
    expel(node, fmt::format("could not load the scene: {}", broken->problem), now);
  }
}

void FarmHost::receive_failure(NodeId node, const ItemFailed& failed, double now) {
  if (failed.phase >= next_number_) throw ProtocolError("a phase that has not begun");
  if (failed.phase + 1 != next_number_) return;  // too late for its phase
  if (!std::visit([&](const auto& phase) { return phase.has(failed.item); }, phase_->phase()))
    throw ProtocolError("an item that does not exist");
  tell_(fmt::format("node {} could not trace {}: {}", node.value(), phase_->name_of(failed.item),
                    failed.problem));
  if (phase_ == &zones_ && assignment_.needs(node, failed.item)) ++result_.zones.retried;
  assignment_.fail(node, failed.item, failed.problem, now);
}

void FarmHost::carry_out(const Action& action) {
  std::visit([this](const auto& a) { carry_out(a); }, action);
}

void FarmHost::carry_out(const OpenedSteps& opened) {
  transport_.broadcast(Channel::control, encode_control(OpenSteps{opened.end}));
}

void FarmHost::carry_out(const NodeLost& lost) {
  NodeResult& node = result_.node(lost.node);
  node.is_lost = true;
  node.had_work |= lost.had_work;
  phase_->forget(lost.node);
  tell_(
      fmt::format("node {} on {} (process {}) {}: {}; {}", node.id.value(), node.machine, node.pid,
                  lost.is_expelled ? "failed" : "is lost",
                  lost.is_expelled ? node.problem : fmt::format("silent for {:g} s", options_.node_timeout_s),
                  lost.had_work ? "others do its work" : "it had no work in hand"));
}

void FarmHost::carry_out(const NodeReturned& returned) {
  result_.node(returned.node).is_lost = false;
  phase_->forget(returned.node);
  tell_(fmt::format("node {} is back", returned.node.value()));
}

void FarmHost::carry_out(const AllNodesLost&) {
  result_.lost_all_nodes = true;
  is_over_ = true;
}

void FarmHost::tell_if_none_is_heard() {
  const bool none = assignment_.nodes_alive() == 0 && !is_over_;
  if (std::exchange(is_waiting_for_any_, none) != none && none)
    tell_(fmt::format("no node can be heard; the host waits {:g} s for one", liveness::kAllSilent_s));
}

void FarmHost::tell_watchers(FarmStage stage, double now) {
  constexpr double kInterval_s = 0.25;
  if (options_.watchers.empty() || now - watchers_told_s_ < kInterval_s) return;
  watchers_told_s_ = now;
  const double in_phase = now - phase_began_s_;
  FarmStatus status = status_of(result_, *transport_.meter(), assignment_);
  status.stage = stage;
  status.now_s = now;
  status.pixels_total = pixels_of(options_);
  if (stage == FarmStage::zones) {
    status.elapsed_s = result_.zones.seconds + in_phase;
    const ZoneProgress zones = zones_.progress();
    status.zone_rounds = zones.rounds;
    status.zone_unsent = zones.unsent;
    status.zone_rays = zones.rays;
  } else {
    status.elapsed_s = result_.times.trace_s + (stage == FarmStage::pictures ? in_phase : 0);
  }
  if (stage == FarmStage::pictures && status.pixels_total > result_.pixels_resumed)
    status.left_s =
        time_left_s(status.elapsed_s, static_cast<double>(status.pixels_done - result_.pixels_resumed) /
                                          static_cast<double>(status.pixels_total - result_.pixels_resumed));
  for (Watcher* const watcher : options_.watchers) watcher->hear(status);
}

void FarmHost::show_progress(bool at_end) {
  const double in_phase = now_s() - phase_began_s_;
  if (zones_.is_at_work()) {
    progress_.show_zones(result_.zones.seconds + in_phase, zones_.progress(), assignment_.nodes_alive());
    return;
  }
  const bool is_traced = at_end || phase_ != &pictures_;
  const double since_s = result_.times.trace_s + (is_traced ? 0 : in_phase);
  if (!at_end && !progress_.is_due(since_s)) return;  // the meter counts node by node
  progress_.show(since_s, result_.pixels_kept, result_.pixels_resumed, result_.rays.total(),
                 picture_result_bytes(result_, *transport_.meter()), assignment_.nodes_alive(), at_end);
}

}  // namespace rayfarm
