#include "host/farm/farm_host.h"

#include <fmt/core.h>

#include <cstring>
#include <limits>

#include "host/process/interrupt.h"
#include "protocol/block_codec.h"
#include "protocol/clock.h"

namespace rayfarm {
namespace {

AssignmentOptions assignment_options(const FarmHostOptions& o, const PicturesPhase& pictures) {
  AssignmentOptions a;
  a.nodes = o.plan.processors;
  a.steps = pictures.steps();
  a.items_per_step = pictures.items_per_step();
  a.window_steps = o.window_frames;
  if (o.plan.policy == AssignmentPolicy::interleaved)
    a.owner_of = [plan = &o.plan, phase = &pictures](ItemIndex item) {
      return owner_of(*plan, *phase, item);
    };
  a.lost_after_s = o.signs.empty() ? std::numeric_limits<double>::infinity() : o.node_timeout_s;
  return a;
}

}  // namespace

FarmHost::FarmHost(Transport& transport, const FarmHostOptions& options, JobResult& result, Tell tell)
    : transport_(transport),
      options_(options),
      pictures_(pictures_of(options.plan)),
      result_(result),
      tell_(std::move(tell)),
      assignment_(assignment_options(options, pictures_), listening_.turn(now_s())),
      progress_(options.progress,
                static_cast<uint64_t>(options.image.window.area()) * pictures_.frames.size()),
      frames_(pictures_.frames.size()),
      pixels_of_node_(static_cast<size_t>(options.plan.processors) + 1),
      step_of_node_(pixels_of_node_.size()) {
  for (FrameIndex i; i.value() < pictures_.steps(); ++i) {
    FrameResult frame;
    frame.frame = pictures_.frames[i.place()];
    index_of_frame_[frame.frame] = i;
    frame.file = options.files[i.place()];
    frame.traced_by.assign(static_cast<size_t>(pictures_.items_per_step()), NodeId());
    if (options.keeps_costs) frame.costs.resize(frame.traced_by.size());
    result_.frames.push_back(frame);
  }
}

ItemIndex FarmHost::item_of(const SubpolygonReport& report) const {
  const auto found = index_of_frame_.find(report.frame);
  if (found == index_of_frame_.end()) throw ProtocolError("a frame that was not asked for");
  if (report.subpolygon < SubpolygonId() || report.subpolygon.value() >= pictures_.items_per_step())
    throw ProtocolError("a subpolygon that does not exist");
  return pictures_.item_of(found->second, report.subpolygon);
}

void FarmHost::run() {
  const double begin = now_s(), cpu_begin = cpu_s();
  result_.times.trace_began_unix_s = unix_s();
  double ticked = 0, looked = 0, traced = begin;
  Backoff backoff;
  while (!assignment_.is_over() && !is_over_) {
    const double now = listening_.turn(now_s());
    bool is_idle = true;
    // A bounded number of messages a turn: whatever comes in, time-outs and signals are looked at too.
    for (int i = 0; i < 1000; ++i) {
      auto message = transport_.try_receive();
      if (!message) break;
      is_idle = false;
      const uint64_t before = result_.pixels_received;
      receive(*message, now);
      if (result_.pixels_received != before) traced = now_s();  // tracing ends with the last result
    }
    if (now - looked > liveness::kLook_s) {
      expel_the_gone(now);
      looked = now;
    }
    if (now - ticked > liveness::kTick_s) {
      assignment_.tick(now);
      ticked = now;
    }
    take_written(now);
    for (const Action& action : assignment_.take_actions()) carry_out(action);
    if (const bool none = assignment_.nodes_alive() == 0 && !is_over_; none != is_waiting_for_any_) {
      is_waiting_for_any_ = none;
      if (none)
        tell_(fmt::format("no node can be heard; the host waits {:g} s for one", liveness::kAllSilent_s));
    }
    if (interrupted_by() != 0) {
      result_.was_interrupted = true;
      is_over_ = true;
    }
    progress_.show(now_s() - begin, result_.pixels_kept, result_.rays.total(),
                   transport_.meter()->total(Command::return_result).bytes, assignment_.nodes_alive());
    if (is_idle) {
      backoff.wait_for(transport_);
    } else {
      backoff.reset();
    }
  }
  writer_.finish();
  take_written(listening_.now());
  const double end = now_s();
  result_.times.host_cpu_s = cpu_s() - cpu_begin;
  result_.times.trace_s = (traced > begin ? traced : end) - begin;
  result_.times.finish_s = end - begin - result_.times.trace_s;
  progress_.show(end - begin, result_.pixels_kept, result_.rays.total(),
                 transport_.meter()->total(Command::return_result).bytes, assignment_.nodes_alive(), true);
  progress_.clear();
}

void FarmHost::receive(const Message& message, double now) {
  const NodeId node = message.source;
  try {
    switch (message.channel) {
      case Channel::control:
        receive_control(node, decode_control(message.bytes), now);
        break;
      case Channel::pixels:
        receive_pixels(node, message.bytes);
        break;
      case Channel::command:
        receive_block(node, message.bytes, now);
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
}

void FarmHost::expel_the_gone(double now) {
  for (size_t i = 0; i < options_.signs.size(); ++i)
    if (options_.signs[i].is_gone()) expel(NodeId(static_cast<int>(i) + 1), "its process is gone", now);
}

void FarmHost::receive_control(NodeId node, const Control& control, double now) {
  if (const auto* done = std::get_if<SubpolygonDone>(&control)) {
    end_of_pixels(node, done->report, now);
  } else if (const auto* failed = std::get_if<ItemFailed>(&control)) {
    if (!pictures_.has(failed->item)) throw ProtocolError("an item that does not exist");
    tell_(fmt::format("node {} could not trace subpolygon {} of frame {}: {}", node.value(),
                      pictures_.subpolygon_of(failed->item).value(),
                      pictures_.number_of(failed->item).value(), failed->problem));
    assignment_.fail(node, failed->item, failed->problem, now);
  } else if (const auto* broken = std::get_if<NodeFailed>(&control)) {
    expel(node, fmt::format("could not load the scene: {}", broken->problem), now);
  }
}

void FarmHost::receive_block(NodeId node, std::span<const std::byte> bytes, double now) {
  const BlockResult block = decode_block(bytes);
  if (!block.is_compressed) {
    keep_result(node, block.report, block.pixels, block.pixels.size(), now);
    return;
  }
  const DisplayPolygon p = pictures_.polygon_of(item_of(block.report));
  keep_result(node, block.report, decompress_rgb8(block.pixels, p.right - p.left + 1, p.bottom - p.top + 1),
              block.pixels.size(), now);
}

void FarmHost::receive_pixels(NodeId node, std::span<const std::byte> bytes) {
  ByteReader reader(bytes);
  auto& pixels = pixels_of_node_[node.place()];
  if (pixels.size() > static_cast<size_t>(options_.image.window.area()))
    throw ProtocolError("more pixels than the image has");
  while (!reader.at_end()) pixels.push_back(read_pixel(reader));
}

void FarmHost::end_of_pixels(NodeId node, const SubpolygonReport& report, double now) {
  const auto pixels = std::exchange(pixels_of_node_[node.place()], {});
  const DisplayPolygon p = pictures_.polygon_of(item_of(report));
  const auto width = static_cast<size_t>(p.right - p.left + 1),
             height = static_cast<size_t>(p.bottom - p.top + 1);
  if (pixels.size() != width * height) throw ProtocolError("a subpolygon with pixels missing");
  std::vector<std::byte> block(3 * pixels.size());
  std::vector<bool> seen(pixels.size());
  for (const PixelResult& pixel : pixels) {
    if (pixel.x < p.left || pixel.x > p.right || pixel.y < p.top || pixel.y > p.bottom)
      throw ProtocolError("a pixel outside of its subpolygon");
    const size_t i = static_cast<size_t>(pixel.y - p.top) * width + static_cast<size_t>(pixel.x - p.left);
    if (seen[i]) throw ProtocolError("a pixel that came twice");
    seen[i] = true;
    for (size_t c = 0; c < 3; ++c) block[3 * i + c] = static_cast<std::byte>(pixel.rgb[c]);
  }
  keep_result(node, report, block, kPixelBytes * pixels.size(), now);
}

void FarmHost::keep_result(NodeId node, const SubpolygonReport& report, std::span<const std::byte> pixels,
                           size_t bytes, double now) {
  const ItemIndex item = item_of(report);
  const DisplayPolygon p = pictures_.polygon_of(item);
  const PixelRect& window = options_.image.window;
  const size_t pixel_bytes = options_.image.layout.bytes;
  const auto width = static_cast<size_t>(p.right - p.left + 1),
             height = static_cast<size_t>(p.bottom - p.top + 1);
  if (pixels.size() != width * height * pixel_bytes)
    throw ProtocolError("a block of another size than its subpolygon");

  const RayCounts rays{report.rays, report.ray_tallies};
  NodeResult& node_result = result_.node(node);
  ++node_result.subpolygons;
  node_result.rays += rays.total();
  node_result.busy_s += static_cast<double>(report.busy_us) * 1e-6;
  result_.pixels_received += width * height;
  if (!assignment_.accept(node, item, now)) {
    ++result_.duplicates;
    return;
  }
  FrameBuffer& frame = frames_[pictures_.frame_of(item).place()];
  if (!frame.is_begun) {
    frame.pixels.resize(static_cast<size_t>(window.area()) * pixel_bytes);
    frame.is_begun = true;
  }
  const size_t row_bytes = static_cast<size_t>(window.width()) * pixel_bytes;
  for (size_t y = 0; y < height; ++y)
    std::memcpy(frame.pixels.data() + (static_cast<size_t>(p.top - window.y0) + y) * row_bytes +
                    static_cast<size_t>(p.left - window.x0) * pixel_bytes,
                pixels.data() + y * width * pixel_bytes, width * pixel_bytes);
  FrameResult& frame_result = result_.frames[pictures_.frame_of(item).place()];
  frame_result.traced_by[report.subpolygon.place()] = node;
  if (options_.keeps_costs)
    frame_result.costs[report.subpolygon.place()] = {static_cast<double>(report.busy_us) * 1e-6, bytes};
  frame_result.sees_anything |= report.sees_anything;
  frame_result.not_finite += report.not_finite;
  frame_result.rays += rays;
  result_.rays += rays;
  result_.pixels_kept += width * height;
}

void FarmHost::carry_out(const Action& action) {
  std::visit([this](const auto& a) { carry_out(a); }, action);
}

void FarmHost::carry_out(const AssignItem& assign) {
  const StepIndex step = pictures_.frame_of(assign.item);
  std::optional<StepIndex>& selected = step_of_node_[assign.node.place()];
  if (selected != step) transport_.send(assign.node, SelectStep{step});
  selected = step;
  transport_.send(assign.node, Channel::command,
                  encode_display_polygon(processor_of(assign.node), pictures_.polygon_of(assign.item)));
}

void FarmHost::carry_out(const OpenedSteps& opened) {
  transport_.broadcast(Channel::control, encode_control(OpenSteps{opened.end}));
}

void FarmHost::carry_out(const StepComplete& complete) {
  const size_t i = complete.step.place();
  FrameWriter::Job job{complete.step, options_.files[i], options_.image, options_.attributes};
  job.image.pixels = std::move(frames_[i].pixels);
  job.attributes["rayfarm/frame"] = fmt::format("{}", pictures_.frames[i].value());
  job.attributes["rayfarm/rays"] = fmt::format("{}", result_.frames[i].rays.total());
  writer_.submit(std::move(job));
}

void FarmHost::carry_out(const StepFailed& failed) {
  FrameResult& frame = result_.frames[failed.step.place()];
  frames_[failed.step.place()].pixels = {};
  frame.problem = fmt::format("a subpolygon failed three times: {}", failed.problem);
  tell_(fmt::format("frame {} failed: {}", frame.frame.value(), frame.problem));
  assignment_.release(failed.step, listening_.now());
}

void FarmHost::carry_out(const NodeLost& lost) {
  NodeResult& node = result_.node(lost.node);
  node.is_lost = true;
  node.had_work |= lost.had_work;
  pixels_of_node_[lost.node.place()] = {};
  tell_(
      fmt::format("node {} on {} (process {}) {}: {}; {}", node.id.value(), node.machine, node.pid,
                  lost.is_expelled ? "failed" : "is lost",
                  lost.is_expelled ? node.problem : fmt::format("silent for {:g} s", options_.node_timeout_s),
                  lost.had_work ? "others do its work" : "it had no work in hand"));
}

void FarmHost::carry_out(const NodeReturned& returned) {
  result_.node(returned.node).is_lost = false;
  step_of_node_[returned.node.place()].reset();
  tell_(fmt::format("node {} is back", returned.node.value()));
}

void FarmHost::carry_out(const AllNodesLost&) {
  result_.lost_all_nodes = true;
  is_over_ = true;
}

void FarmHost::tell_what_is_odd(const FrameResult& frame) const {
  if (frame.not_finite > 0)
    tell_(
        fmt::format("frame {}: {} pixels are infinite or not a number; the scene asks for light beyond all "
                    "bounds",
                    frame.frame.value(), frame.not_finite));
  if (!frame.is_black && frame.sees_anything) return;
  const Image& image = options_.image;
  if (!frame.sees_anything && image.window != PixelRect{0, 0, image.width_px, image.height_px})
    tell_(fmt::format("frame {}: no object is seen in the part that --crop asks for", frame.frame.value()));
  else if (!frame.sees_anything)
    tell_(
        fmt::format("frame {}: the camera sees nothing of the scene; check the view's location and "
                    "direction (rayfarm info prints the scene's bounds)",
                    frame.frame.value()));
  else
    tell_(
        fmt::format("frame {}: every pixel is black: no light reaches what the camera sees; rayfarm check "
                    "names lights that can't shine",
                    frame.frame.value()));
}

void FarmHost::take_written(double now) {
  while (const auto written = writer_.try_take()) {
    FrameResult& frame = result_.frames[written->frame.place()];
    frame.problem = written->problem;
    frame.sha256 = written->sha256;
    frame.is_written = written->problem.empty();
    frame.is_black = written->is_black;
    result_.times.write_s += written->seconds;
    if (!written->problem.empty())
      tell_(fmt::format("frame {} failed: {}", frame.frame.value(), written->problem));
    tell_what_is_odd(frame);
    assignment_.release(written->frame, now);
  }
}

}  // namespace rayfarm
