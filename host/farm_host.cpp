#include "host/farm_host.h"

#include <fmt/core.h>

#include <cstring>
#include <limits>

#include "host/interrupt.h"
#include "protocol/block_codec.h"
#include "protocol/clock.h"

namespace rayfarm {
namespace {

constexpr double kTickInterval_s = 0.1;

AssignmentOptions assignment_options(const FarmHostOptions& o) {
  AssignmentOptions a;
  a.policy = o.plan.policy;
  a.grid = o.plan.grid;
  a.rotates = o.plan.rotates;
  a.nodes = o.plan.processors;
  a.frames = static_cast<int>(o.plan.frames.size());
  a.window_frames = o.window_frames;
  a.lost_after_s = o.signs.empty() ? std::numeric_limits<double>::infinity() : o.node_timeout_s;
  return a;
}

}  // namespace

FarmHost::FarmHost(Transport& transport, const FarmHostOptions& options, JobResult& result, Tell tell)
    : transport_(transport),
      options_(options),
      result_(result),
      tell_(std::move(tell)),
      assignment_(assignment_options(options), listening_.turn(now_s())),
      progress_(options.progress,
                static_cast<uint64_t>(options.image.window.area()) * options.plan.frames.size()),
      frames_(options.plan.frames.size()),
      pixels_of_node_(static_cast<size_t>(options.plan.processors) + 1),
      frame_of_node_(pixels_of_node_.size(), -1) {
  for (size_t i = 0; i < options.plan.frames.size(); ++i) {
    index_of_frame_[options.plan.frames[i]] = static_cast<int>(i);
    FrameResult frame;
    frame.frame = options.plan.frames[i];
    frame.file = options.files[i];
    frame.traced_by.assign(static_cast<size_t>(options.plan.grid.count()), 0);
    frame.costs.resize(frame.traced_by.size());
    result_.frames.push_back(frame);
  }
}

int FarmHost::frame_index(uint32_t frame) const {
  const auto found = index_of_frame_.find(static_cast<int>(frame));
  return found == index_of_frame_.end() ? -1 : found->second;
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
    if (now - ticked > kTickInterval_s) {
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
      backoff.wait();
    } else {
      backoff.reset();
    }
  }
  writer_.finish();
  take_written(listening_.now());
  const double end = now_s();
  result_.times.host_cpu_s = cpu_s() - cpu_begin;
  result_.times.trace_s = (traced > begin ? traced : end) - begin;
  progress_.show(end - begin, result_.pixels_kept, result_.rays.total(),
                 transport_.meter()->total(Command::return_result).bytes, assignment_.nodes_alive(), true);
  progress_.clear();
}

void FarmHost::receive(const Message& message, double now) {
  const int node = message.source;
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

void FarmHost::expel(int node, const std::string& problem, double now) {
  NodeResult& result = result_.nodes[static_cast<size_t>(node) - 1];
  if (!result.problem.empty()) return;
  result.problem = problem;
  if (result.is_lost) tell_(fmt::format("node {} {}; it stays lost", node, problem));
  assignment_.expel(node, now);
}

void FarmHost::expel_the_gone(double now) {
  for (size_t i = 0; i < options_.signs.size(); ++i)
    if (options_.signs[i].is_gone()) expel(static_cast<int>(i) + 1, "its process is gone", now);
}

void FarmHost::receive_control(int node, const Control& control, double now) {
  if (const auto* done = std::get_if<SubpolygonDone>(&control)) {
    end_of_pixels(node, done->report, now);
  } else if (const auto* failed = std::get_if<SubpolygonFailed>(&control)) {
    tell_(fmt::format("node {} could not trace subpolygon {} of frame {}: {}", node, failed->subpolygon,
                      failed->frame, failed->problem));
    assignment_.fail(node, frame_index(failed->frame), static_cast<int>(failed->subpolygon), failed->problem,
                     now);
  } else if (const auto* broken = std::get_if<NodeFailed>(&control)) {
    expel(node, fmt::format("could not load the scene: {}", broken->problem), now);
  }
}

void FarmHost::receive_block(int node, std::span<const std::byte> bytes, double now) {
  const BlockResult block = decode_block(bytes);
  if (block.report.subpolygon >= static_cast<uint32_t>(options_.plan.grid.count()))
    throw ProtocolError("a subpolygon that does not exist");
  if (!block.is_compressed) {
    keep_result(node, block.report, block.pixels, block.pixels.size(), now);
    return;
  }
  const DisplayPolygon p = options_.plan.grid.polygon(static_cast<int>(block.report.subpolygon));
  keep_result(node, block.report, decompress_rgb8(block.pixels, p.right - p.left + 1, p.bottom - p.top + 1),
              block.pixels.size(), now);
}

void FarmHost::receive_pixels(int node, std::span<const std::byte> bytes) {
  ByteReader reader(bytes);
  auto& pixels = pixels_of_node_[static_cast<size_t>(node)];
  if (pixels.size() > static_cast<size_t>(options_.image.window.area()))
    throw ProtocolError("more pixels than the image has");
  while (!reader.at_end()) pixels.push_back(read_pixel(reader));
}

void FarmHost::end_of_pixels(int node, const SubpolygonReport& report, double now) {
  const auto pixels = std::exchange(pixels_of_node_[static_cast<size_t>(node)], {});
  if (report.subpolygon >= static_cast<uint32_t>(options_.plan.grid.count()))
    throw ProtocolError("a subpolygon that does not exist");
  const DisplayPolygon p = options_.plan.grid.polygon(static_cast<int>(report.subpolygon));
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

void FarmHost::keep_result(int node, const SubpolygonReport& report, std::span<const std::byte> pixels,
                           size_t bytes, double now) {
  const int index = frame_index(report.frame);
  if (index < 0) throw ProtocolError("a frame that was not asked for");
  const auto subpolygon = static_cast<int>(report.subpolygon);
  const DisplayPolygon p = options_.plan.grid.polygon(subpolygon);
  const PixelRect& window = options_.image.window;
  const size_t pixel_bytes = options_.image.layout.bytes;
  const auto width = static_cast<size_t>(p.right - p.left + 1),
             height = static_cast<size_t>(p.bottom - p.top + 1);
  if (pixels.size() != width * height * pixel_bytes)
    throw ProtocolError("a block of another size than its subpolygon");

  const RayCounts rays{report.rays};
  NodeResult& node_result = result_.nodes[static_cast<size_t>(node) - 1];
  ++node_result.subpolygons;
  node_result.rays += rays.total();
  node_result.busy_s += static_cast<double>(report.busy_us) * 1e-6;
  result_.pixels_received += width * height;
  if (!assignment_.accept(node, index, subpolygon, now)) {
    ++result_.duplicates;
    return;
  }
  FrameState& frame = frames_[static_cast<size_t>(index)];
  if (!frame.is_begun) {
    frame.pixels.resize(static_cast<size_t>(window.area()) * pixel_bytes);
    frame.is_begun = true;
  }
  const size_t row_bytes = static_cast<size_t>(window.width()) * pixel_bytes;
  for (size_t y = 0; y < height; ++y)
    std::memcpy(frame.pixels.data() + (static_cast<size_t>(p.top - window.y0) + y) * row_bytes +
                    static_cast<size_t>(p.left - window.x0) * pixel_bytes,
                pixels.data() + y * width * pixel_bytes, width * pixel_bytes);
  FrameResult& frame_result = result_.frames[static_cast<size_t>(index)];
  frame_result.traced_by[static_cast<size_t>(subpolygon)] = node;
  frame_result.costs[static_cast<size_t>(subpolygon)] = {static_cast<double>(report.busy_us) * 1e-6, bytes};
  frame_result.sees_anything |= report.sees_anything;
  frame_result.not_finite += report.not_finite;
  frame_result.rays += rays;
  result_.rays += rays;
  result_.pixels_kept += width * height;
}

void FarmHost::carry_out(const Action& action) {
  if (const auto* assign = std::get_if<AssignSubpolygon>(&action)) {
    const int frame = options_.plan.frames[static_cast<size_t>(assign->frame)];
    int& selected = frame_of_node_[static_cast<size_t>(assign->node)];
    if (selected != frame) transport_.send(assign->node, SelectFrame{static_cast<uint32_t>(frame)});
    selected = frame;
    transport_.send(assign->node, Channel::command,
                    encode_display_polygon(static_cast<uint16_t>(assign->node - 1),
                                           options_.plan.grid.polygon(assign->subpolygon)));
  } else if (const auto* open = std::get_if<OpenFrames>(&action)) {
    transport_.broadcast(Channel::control, encode_control(OpenWindow{static_cast<uint32_t>(open->end)}));
  } else if (const auto* complete = std::get_if<FrameComplete>(&action)) {
    const auto i = static_cast<size_t>(complete->frame);
    FrameWriter::Job job{complete->frame, options_.files[i], options_.image, options_.attributes};
    job.image.pixels = std::move(frames_[i].pixels);
    job.attributes["rayfarm/frame"] = fmt::format("{}", options_.plan.frames[i]);
    job.attributes["rayfarm/rays"] = fmt::format("{}", result_.frames[i].rays.total());
    writer_.submit(std::move(job));
  } else if (const auto* failed = std::get_if<FrameFailed>(&action)) {
    const auto i = static_cast<size_t>(failed->frame);
    frames_[i].pixels = {};
    result_.frames[i].problem = fmt::format("a subpolygon failed three times: {}", failed->problem);
    tell_(fmt::format("frame {} failed: {}", result_.frames[i].frame, result_.frames[i].problem));
    assignment_.release(failed->frame, listening_.now());
  } else if (const auto* lost = std::get_if<NodeLost>(&action)) {
    NodeResult& node = result_.nodes[static_cast<size_t>(lost->node) - 1];
    node.is_lost = true;
    node.had_work |= lost->had_work;
    pixels_of_node_[static_cast<size_t>(lost->node)] = {};
    tell_(fmt::format(
        "node {} on {} (process {}) {}: {}; {}", node.id, node.machine, node.pid,
        lost->is_expelled ? "failed" : "is lost",
        lost->is_expelled ? node.problem : fmt::format("silent for {:g} s", options_.node_timeout_s),
        lost->had_work ? "others do its work" : "it had no work in hand"));
  } else if (const auto* returned = std::get_if<NodeReturned>(&action)) {
    result_.nodes[static_cast<size_t>(returned->node) - 1].is_lost = false;
    frame_of_node_[static_cast<size_t>(returned->node)] = -1;
    tell_(fmt::format("node {} is back", returned->node));
  } else {
    result_.lost_all_nodes = true;
    is_over_ = true;
  }
}

void FarmHost::tell_what_is_odd(const FrameResult& frame) const {
  if (frame.not_finite > 0)
    tell_(
        fmt::format("frame {}: {} pixels are infinite or not a number; the scene asks for light beyond all "
                    "bounds",
                    frame.frame, frame.not_finite));
  if (!frame.is_black && frame.sees_anything) return;
  const Image& image = options_.image;
  if (!frame.sees_anything && image.window != PixelRect{0, 0, image.width_px, image.height_px})
    tell_(fmt::format("frame {}: no object is seen in the part that --crop asks for", frame.frame));
  else if (!frame.sees_anything)
    tell_(
        fmt::format("frame {}: the camera sees nothing of the scene; check the view's location and "
                    "direction (rayfarm info prints the scene's bounds)",
                    frame.frame));
  else
    tell_(
        fmt::format("frame {}: every pixel is black: no light reaches what the camera sees; rayfarm check "
                    "names lights that can't shine",
                    frame.frame));
}

void FarmHost::take_written(double now) {
  while (const auto written = writer_.try_take()) {
    FrameResult& frame = result_.frames[static_cast<size_t>(written->frame_index)];
    frame.problem = written->problem;
    frame.sha256 = written->sha256;
    frame.is_written = written->problem.empty();
    frame.is_black = written->is_black;
    result_.times.write_s += written->seconds;
    if (!written->problem.empty()) tell_(fmt::format("frame {} failed: {}", frame.frame, written->problem));
    tell_what_is_odd(frame);
    assignment_.release(written->frame_index, now);
  }
}

}  // namespace rayfarm
