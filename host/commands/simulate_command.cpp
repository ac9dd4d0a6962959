#include <fmt/core.h>

#include <numeric>
#include <utility>

#include "host/commands/commands.h"
#include "host/commands/net_options.h"
#include "host/instrument/cost_map.h"
#include "host/instrument/missing_subpolygons.h"
#include "host/process/exit_code.h"
#include "protocol/messages.h"

namespace rayfarm {
namespace {

constexpr int kMostCount = 1 << 24;

struct SimulateOptions {
  Simulation simulation;
  double pixel_time_s = 0;  ///< what a pixel is to cost on average; 0: what the cost map says
  std::vector<int> processors{1, 2, 4, 8, 16, 32};  ///< one row each
  std::optional<int> least_side_px;                 ///< of a subpolygon; empty: the wire's
  TableFormat format = TableFormat::text;
};

/// Names options that do nothing beside others.
void note_idle_options(const Simulation& s) {
  if (s.policy == AssignmentPolicy::interleaved) return;
  for (const auto& [name, is_set] :
       {std::pair{"--sets", s.sets != SetPattern::lattice}, std::pair{"--no-rotation", !s.rotates}})
    if (is_set)
      fmt::print(stderr, "rayfarm: {} belongs to --assign interleaved, and does nothing here\n", name);
}

int print_simulation(const SimulateOptions& options) {
  Simulation s = options.simulation;
  note_idle_options(s);
  s.least_side_px = options.least_side_px.value_or(least_side_of(s.form));
  if (options.pixel_time_s > 0) {
    const double mean = std::accumulate(s.cost.pixel_s.begin(), s.cost.pixel_s.end(), 0.0) /
                        static_cast<double>(s.cost.pixel_s.size());
    for (double& cost : s.cost.pixel_s) cost *= options.pixel_time_s / mean;
  }
  Table table{"simulation",
              {"processors", "first_frame_s", "frame_s", "total_s", "speedup", "efficiency", "net_use",
               "waited_s", "messages", "bytes_per_pixel"},
              {}};
  bool is_told = false;
  for (const int processors : options.processors) {
    s.processors = processors;
    if (const std::string missing =
            tell_missing_subpolygons(grid_of(s), processors, s.subpolygons_per_processor, s.least_side_px);
        !missing.empty() && !std::exchange(is_told, true))
      fmt::print(stderr, "rayfarm: {}\n", missing);
    const SimulationResult r = simulate(s);
    const double pixels = double(s.cost.width_px) * s.cost.height_px * s.frames;
    table.rows.push_back({double(processors), r.first_frame_s, r.frame_s, r.total_s,
                          r.frame_s > 0 ? r.busy_s / s.frames / r.frame_s : 0, r.efficiency, r.net_use,
                          r.waited_s, double(r.messages), r.bytes / pixels});
  }
  fmt::print("{}", format_tables({table}, options.format));
  return kComplete;
}

void add_choices(Options& options, Simulation& s) {
  options.choice<AssignmentPolicy>(
      "--assign", s.policy,
      {{"interleaved", AssignmentPolicy::interleaved}, {"on-demand", AssignmentPolicy::on_demand}},
      "who traces what (default: interleaved)");
  options.choice<ResultForm>(
      "--wire", s.form,
      {{"block", ResultForm::blocks}, {"compressed", ResultForm::compressed}, {"pixel", ResultForm::pixels}},
      "form of results; compressed: as small as the cost map says (default: pixel)");
  options.choice<NetShape>("--net", s.net, {{"bus", NetShape::bus}, {"switch", NetShape::ports}},
                           "one medium for all, or a switch with full duplex (default: bus)");
}

void add_numbers(Options& options, Simulation& s) {
  const auto count = [&options](const char* name, int& target, int least, const char* help) {
    options.number(name, target, least, kMostCount, help);
  };
  const auto number = [&options](const char* name, double& target, double most, const char* help) {
    return options.number(name, target, 0, most, help);
  };
  count("--subpolygons", s.subpolygons_per_processor, 1, "per processor (default: 64)");
  count("--frames-open", s.frames_open, 1, "at once (default: 3)");
  count("--pixels-per-message", s.pixels_per_message, 1, "of the pixel wire (default: 1)");
  count("--held", s.messages_held, 0,
        "messages that a processor may have unsent; 1: it waits for the net; 0: any number (default: 1)");
  count("--assigned-ahead", s.assigned_ahead, 1, "on demand: subpolygons that a processor has (default: 2)");
  count("--nets", s.nets, 1, "each with its share of the processors (default: 1)");
  count("--frame-buffers", s.frame_buffers, 1, "that take turns at the subpolygons (default: 1)");
  number("--frame-buffer-time", s.frame_buffer_s, 1e3, "seconds in which one stores a pixel (default: 0)")
      .takes("S");
  number("--host-time", s.host_message_s, 1e3, "seconds that the host spends on a message (default: 0)")
      .takes("S");
  number("--message-bytes", s.message_bytes, 1e6, "that the net adds to a packet (default: 0)");
  number("--packet-bytes", s.packet_bytes, 1e9, "the most that a packet carries (default: 0, no limit)");
  number("--latency", s.latency_s, 1e3, "of a message in seconds, beside its transmission (default: 0)")
      .takes("S");
  number("--load-bytes", s.load_bytes, 1e15, "of code and data, broadcast once (default: 0)");
  options.numbers("--processor-times", s.time_factors, 1e-3, 1e3, "1,1,2: factors by processor, in turn");
}

}  // namespace

void add_simulate_command(CommandLine& line) {
  const auto o = std::make_shared<SimulateOptions>();
  Simulation& s = o->simulation;
  Verb verb;
  verb.name = "simulate";
  verb.help = "simulate the net with up to 16,383 processors, event by event";
  verb.examples = {{"rayfarm simulate --cost-map cost.json --processors 8,64,512 --rate 1gbit",
                    "how a job that was measured would scale (rayfarm render --cost-map wrote the file)"}};
  verb.run = [o](const Renders&) { return print_simulation(*o); };
  Options options = line.add(std::move(verb));
  options
      .text(
          "--cost-map", [&s](const std::string& path) { s.cost = read_cost_map(path); },
          "what `rayfarm render --cost-map` wrote (default: 1024 × 1024 pixels that cost the same)", "FILE")
      .read_first();
  options
      .number("--pixel-time", o->pixel_time_s, 1e-15, 1e6,
              "seconds that a pixel costs on average: scales the map (default: as it is; 0.04 without one)")
      .takes("S");
  options.numbers("--processors", o->processors, 1, kMostProcessors,
                  "1,2,4: one row each (default: 1,2,4,8,16,32)");
  options.number("--frames", s.frames, 1, 10000, "of the sequence (default: 1)");
  add_choices(options, s);
  add_rate(options, s.rate_bit_per_s);
  add_sets(options, s.sets);
  options.flag("!--no-rotation", s.rotates, "interleaved: each processor keeps its set in every frame");
  options.number("--least-side", o->least_side_px, 1, kMostCount,
                 "of a subpolygon in pixels (default: as a render's, 1 on the pixel wire and 8 for blocks)");
  add_numbers(options, s);
  add_format(options, o->format);
}

}  // namespace rayfarm
