#include "host/farm/report.h"

#include <fmt/core.h>

#include <iterator>

#include "host/farm/progress.h"

namespace rayfarm {

uint64_t picture_result_bytes(const JobResult& result, const TrafficMeter& meter) {
  return meter.total(Command::return_result).bytes - result.zones.result_bytes;
}

double bytes_per_received_pixel(const JobResult& result, const TrafficMeter& meter) {
  return result.pixels_received == 0 ? 0
                                     : static_cast<double>(picture_result_bytes(result, meter)) /
                                           static_cast<double>(result.pixels_received);
}

namespace {

/// What item buffers did; empty without.
std::string format_items(const RayCounts& rays) {
  if (rays[RayTally::eye_items] + rays[RayTally::shadow_items] + rays[RayTally::compared] == 0) return {};
  std::string text = fmt::format(
      "items    {} eye rays hit the item of their corner; {} shadow rays that of their "
      "light\n",
      rays[RayTally::eye_items], rays[RayTally::shadow_items]);
  if (rays[RayTally::compared] > 0)
    text += fmt::format("         {} of {} eye rays would hit something else in an ordinary search\n",
                        rays[RayTally::differing], rays[RayTally::compared]);
  return text;
}

/// What was done for zones; empty if nothing was.
std::string format_zones(const ZonesResult& zones) {
  std::string text;
  if (zones.stages > 0)
    text = fmt::format("zones    {} stage{}, {} round{}, {} in {:.2f} s; {} to nodes, {} back\n",
                       zones.stages, zones.stages == 1 ? "" : "s", zones.rounds, zones.rounds == 1 ? "" : "s",
                       format_rate(static_cast<double>(zones.rays.total()), "rays"), zones.seconds,
                       format_rate(static_cast<double>(zones.data_bytes + zones.assignment_bytes), "bytes"),
                       format_rate(static_cast<double>(zones.result_bytes), "bytes"));
  if (zones.read > 0)
    text += fmt::format("zones    of {} pose{} from files\n", zones.read, zones.read == 1 ? "" : "s");
  return text;
}

/// Which nodes were lost; empty if none was.
std::string format_losses(const JobResult& result) {
  std::string text;
  auto out = std::back_inserter(text);
  constexpr size_t kMostLosses = 3;
  // mpirun ends all nodes when it is stopped: that is no loss.
  const std::vector<NodeId> lost = result.was_interrupted ? std::vector<NodeId>() : result.lost_nodes();
  for (size_t i = 0; i < std::min(lost.size(), kMostLosses); ++i) {
    const NodeResult& node = result.node(lost[i]);
    fmt::format_to(out, "lost     node {} on {} (process {}){}{}\n", node.id.value(), node.machine, node.pid,
                   node.problem.empty() ? "" : ": " + node.problem,
                   i + 1 == kMostLosses && lost.size() > kMostLosses
                       ? fmt::format("; and {} more", lost.size() - kMostLosses)
                       : "");
  }
  if (!lost.empty())
    text += "         (Open MPI may print lines such as PMIX ERROR about it: they are harmless)\n";
  return text;
}

}  // namespace

std::string format_report(const JobResult& result, const TrafficMeter& meter) {
  std::string text;
  auto out = std::back_inserter(text);
  std::vector<const FrameResult*> written;
  for (const FrameResult& frame : result.frames)
    if (frame.is_written) written.push_back(&frame);
  if (result.frames.size() == 1 && written.size() == 1)
    fmt::format_to(out, "picture  {}\n", written[0]->file);
  else if (written.empty())
    fmt::format_to(out, "picture  none of {} written\n", result.frames.size());
  else
    fmt::format_to(out, "pictures {} of {} written: {}{}\n", written.size(), result.frames.size(),
                   written.front()->file, written.size() > 1 ? " … " + written.back()->file : "");
  const JobTimes& t = result.times;
  fmt::format_to(
      out, "time     {:.2f} s: load {:.2f}, build {:.2f}, broadcast {:.2f}, trace {:.2f}, write {:.2f}\n",
      t.total_s, t.load_s, t.build_s, t.broadcast_s, t.trace_s, t.write_s);
  if (result.pixels_resumed > 0)
    fmt::format_to(out, "resumed  {} of {} pixels were there\n",
                   format_count(static_cast<double>(result.pixels_resumed)),
                   format_count(static_cast<double>(result.pixels_kept)));
  const auto rays = static_cast<double>(result.rays.total());
  fmt::format_to(out, "rays     {}", format_count(rays));
  const char* separator = ": ";
  for (size_t i = 0; i < kRayKinds; ++i) {
    if (result.rays.by_kind[i] == 0) continue;
    fmt::format_to(out, "{}{} {}", separator, kRayKindNames[i],
                   format_count(static_cast<double>(result.rays.by_kind[i])));
    separator = ", ";
  }
  fmt::format_to(out, "\n{}{}speed    {} on {} node{}\n", format_zones(result.zones),
                 format_items(result.rays), format_rate(t.trace_s > 0 ? rays / t.trace_s : 0, "rays/s"),
                 result.nodes.size(), result.nodes.size() == 1 ? "" : "s");
  fmt::format_to(out, "net      {:.2f} bytes per pixel in results; the thesis's model: {:.0f}\n",
                 bytes_per_received_pixel(result, meter), kModelBytesPerPixel);
  return text + format_losses(result);
}

std::string format_zones_report(const JobResult& result, const std::string& made) {
  const JobTimes& t = result.times;
  return fmt::format(
      "baked    {}\ntime     {:.2f} s: load {:.2f}, build {:.2f}, broadcast {:.2f}, write {:.2f}\n{}{}", made,
      t.total_s, t.load_s, t.build_s, t.broadcast_s, t.write_s, format_zones(result.zones),
      format_losses(result));
}

std::string format_full_report(const JobResult& result, const TrafficMeter& meter) {
  std::string text;
  auto out = std::back_inserter(text);
  const uint64_t rays = result.rays.total();
  fmt::format_to(out, "\ntraffic                  messages          bytes\n");
  for (const Command command : kAllCommands) {
    const Traffic t = meter.total(command);
    fmt::format_to(out, "  {:<21} {:>9} {:>14}\n", name_of(command), t.messages, t.bytes);
  }
  const Traffic control = meter.total_control();
  fmt::format_to(out, "  {:<21} {:>9} {:>14}\n", "control", control.messages, control.bytes);
  const double bytes = bytes_per_received_pixel(result, meter);
  fmt::format_to(out, "  results: {:.3f} bytes per pixel; the thesis's model: {:.0f}, {:.1f} times as many\n",
                 bytes, kModelBytesPerPixel, bytes > 0 ? kModelBytesPerPixel / bytes : 0.0);
  const JobTimes& t = result.times;
  fmt::format_to(out,
                 "time   load {:.2f} s, build {:.2f} s, broadcast {:.2f} s, trace {:.2f} s, write {:.2f} s, "
                 "total {:.2f} s\n",
                 t.load_s, t.build_s, t.broadcast_s, t.trace_s, t.write_s, t.total_s);
  fmt::format_to(out, "rays   {} in all, {}", format_count(static_cast<double>(rays)),
                 format_rate(t.trace_s > 0 ? static_cast<double>(rays) / t.trace_s : 0, "rays/s"));
  for (size_t i = 0; i < kRayKinds; ++i)
    if (result.rays.by_kind[i] > 0) fmt::format_to(out, "; {} {}", kRayKindNames[i], result.rays.by_kind[i]);
  fmt::format_to(out, "\ntrees  {:.3f} rays deep on average; {} rays cut by --min-weight\n{}",
                 result.rays.average_depth(), result.rays[RayTally::cut], format_items(result.rays));
  fmt::format_to(out, "node   subpolygons          rays     busy     idle  machine\n");
  for (const NodeResult& n : result.nodes)
    fmt::format_to(out, "{:>4}   {:>11}  {:>12}  {:>6.2f} s  {:>6.2f} s  {}{}\n", n.id.value(), n.subpolygons,
                   n.rays, n.busy_s, result.idle_s(n), n.machine, n.is_lost ? "  LOST" : "");
  if (result.zones.stages > 0) {
    fmt::format_to(out, "zones  {} results of items; {} items failed and were tried again; busy:",
                   result.zones.results, result.zones.retried);
    for (const NodeResult& n : result.nodes) fmt::format_to(out, " {:.2f} s", n.zone_busy_s);
    fmt::format_to(out, "\n");
  }
  if (result.duplicates > 0)
    fmt::format_to(out, "{} results came twice and were dropped\n", result.duplicates);
  if (result.frames.size() > 1) {
    constexpr size_t kMostRows = 24, kMostColumns = 48;
    fmt::format_to(out, "who traced what: the node of each frame's first subpolygons\n");
    for (size_t f = 0; f < result.frames.size() && f < kMostRows; ++f) {
      fmt::format_to(out, "  frame {:>5}:", result.frames[f].frame.value());
      for (size_t s = 0; s < result.frames[f].traced_by.size() && s < kMostColumns; ++s)
        fmt::format_to(out, " {}", result.frames[f].traced_by[s].value());
      fmt::format_to(out, "\n");
    }
    if (result.frames.size() > kMostRows) fmt::format_to(out, "  … (all in --stats)\n");
  }
  return text;
}

}  // namespace rayfarm
