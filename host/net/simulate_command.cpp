#include <fmt/core.h>

#include <numeric>

#include "host/exit_code.h"
#include "host/net/cost_map.h"
#include "host/net/net_commands.h"
#include "host/net/net_flags.h"
#include "host/net/table.h"

namespace rayfarm {

void add_simulate_command(CLI::App& app, CommandLine& line) {
  SimulateOptions& o = line.simulate;
  Simulation& s = o.simulation;
  CLI::App* simulate =
      app.add_subcommand("simulate", "simulate the net with up to 16,383 processors, event by event");
  simulate
      ->add_option_function<std::string>(
          "--cost-map", [&s](const std::string& path) { s.cost = read_cost_map(path); },
          "what `rayfarm render --cost-map` wrote (default: 1024 × 1024 pixels that cost the same)")
      ->type_name("FILE")
      ->trigger_on_parse();
  simulate
      ->add_option(
          "--pixel-time", o.pixel_time_s,
          "seconds that a pixel costs on average: scales the map (default: as it is; 0.04 without one)")
      ->check(CLI::Range(1e-15, 1e6));
  simulate->add_option("--processors", o.processors, "1,2,4: one row each (default: 1,2,4,8,16,32)")
      ->delimiter(',')
      ->check(CLI::Range(1, kMostProcessors));
  simulate->add_option("--frames", s.frames, "of the sequence (default: 1)")->check(CLI::Range(1, 10000));
  const auto choice = [simulate](const char* name, auto& target, const auto& choices, const char* help) {
    simulate->add_option(name, target, help)->transform(CLI::CheckedTransformer(choices));
  };
  choice("--assign", s.policy,
         std::map<std::string, AssignmentPolicy>{{"interleaved", AssignmentPolicy::interleaved},
                                                 {"on-demand", AssignmentPolicy::on_demand}},
         "who traces what (default: interleaved)");
  choice("--wire", s.form,
         std::map<std::string, ResultForm>{{"pixel", ResultForm::pixels},
                                           {"block", ResultForm::blocks},
                                           {"compressed", ResultForm::compressed}},
         "form of results; compressed: as small as the cost map says (default: pixel)");
  choice("--net", s.net, std::map<std::string, NetShape>{{"bus", NetShape::bus}, {"switch", NetShape::ports}},
         "one medium for all, or a switch with full duplex (default: bus)");
  add_rate(simulate, s.rate_bit_per_s);
  simulate->add_flag("!--no-rotation", s.rotates, "interleaved: each processor keeps its set in every frame");
  const auto count = [simulate](const char* name, int& target, int least, const char* help) {
    simulate->add_option(name, target, help)->check(CLI::Range(least, 1 << 24));
  };
  const auto number = [simulate](const char* name, double& target, double most, const char* help) {
    simulate->add_option(name, target, help)->check(CLI::Range(0.0, most));
  };
  count("--subpolygons", s.subpolygons_per_processor, 1, "per processor (default: 64)");
  count("--least-side", s.least_side_px, 1, "of a subpolygon in pixels (default: 1; a render's is 8)");
  count("--frames-open", s.frames_open, 1, "at once (default: 3)");
  count("--pixels-per-message", s.pixels_per_message, 1, "of the pixel wire (default: 1)");
  count("--held", s.messages_held, 0,
        "messages that a processor may have unsent; 1: it waits for the net; 0: any number (default: 1)");
  count("--assigned-ahead", s.assigned_ahead, 1, "on demand: subpolygons that a processor has (default: 2)");
  count("--nets", s.nets, 1, "each with its share of the processors (default: 1)");
  count("--frame-buffers", s.frame_buffers, 1, "that take turns at the subpolygons (default: 1)");
  number("--frame-buffer-time", s.frame_buffer_s, 1e3, "seconds in which one stores a pixel (default: 0)");
  number("--host-time", s.host_message_s, 1e3, "seconds that the host spends on a message (default: 0)");
  number("--message-bytes", s.message_bytes, 1e6, "that the net adds to a packet (default: 0)");
  number("--packet-bytes", s.packet_bytes, 1e9, "the most that a packet carries (default: 0, no limit)");
  number("--latency", s.latency_s, 1e3, "of a message in seconds, beside its transmission (default: 0)");
  number("--load-bytes", s.load_bytes, 1e15, "of code and data, broadcast once (default: 0)");
  simulate->add_option("--processor-times", s.time_factors, "1,1,2: factors by processor, in turn")
      ->delimiter(',')
      ->check(CLI::Range(1e-3, 1e3));
  add_format(simulate, o.format);
  simulate->callback([&line] { line.kind = CommandKind::simulate; });
}

int run_simulate(const SimulateOptions& options) {
  Simulation s = options.simulation;
  if (options.pixel_time_s > 0) {
    const double mean = std::accumulate(s.cost.pixel_s.begin(), s.cost.pixel_s.end(), 0.0) /
                        static_cast<double>(s.cost.pixel_s.size());
    for (double& cost : s.cost.pixel_s) cost *= options.pixel_time_s / mean;
  }
  Table table{"simulation",
              {"processors", "first_frame_s", "frame_s", "total_s", "speedup", "efficiency", "net_use",
               "waited_s", "messages", "bytes_per_pixel"},
              {}};
  for (const int processors : options.processors) {
    s.processors = processors;
    const SimulationResult r = simulate(s);
    const double pixels = double(s.cost.width_px) * s.cost.height_px * s.frames;
    table.rows.push_back({double(processors), r.first_frame_s, r.frame_s, r.total_s,
                          r.frame_s > 0 ? r.busy_s / s.frames / r.frame_s : 0, r.efficiency, r.net_use,
                          r.waited_s, double(r.messages), r.bytes / pixels});
  }
  fmt::print("{}", format_tables({table}, options.format));
  return kComplete;
}

}  // namespace rayfarm
