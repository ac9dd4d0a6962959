#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/errors/input_error.h"
#include "common/lighting/ray_counts.h"
#include "host/commands/commands.h"
#include "host/commands/net_options.h"
#include "host/files/json.h"
#include "host/instrument/model.h"
#include "host/process/exit_code.h"
#include "protocol/messages.h"

namespace rayfarm {
namespace {

struct ModelOptions {
  NetModel model;
  std::vector<double> wire_bytes;  ///< per pixel, of further wires
  std::vector<double> processors;  ///< rows of the table; empty: powers of two and what the model solves for
  TableFormat format = TableFormat::text;
};

/// How many stages of zones a render had; 0 if it had none.
double stages_of(const JsonView& statistics) {
  return statistics.has("zones") ? statistics.at("zones").at("stages").number() : 0;
}

/// As if each stage were a round.
void read_zones(const JsonView& statistics, double stages, ZonesModel& model) {
  const JsonView zones = statistics.at("zones");
  double rays = 0, busy_s = 0;
  for (const char* kind : kRayKindNames) rays += zones.at("rays").at(kind).number();
  for (const JsonView& node : statistics.at("nodes").elements()) busy_s += node.at("zone_busy_s").number();
  model.rounds = stages;
  model.zones = zones.at("data_bytes").number() / stages / kZoneBytes;
  model.rays = rays / stages;
  model.ray_time_s = rays > 0 ? busy_s / rays : 0;
  model.result_bytes = zones.at("result_bytes").number() / stages;
}

/// Takes from the statistics of a real render what the model needs.
void read_statistics(const std::string& path, NetModel& model) {
  try {
    const JsonView j = JsonView::read_file(path);
    const double frames = static_cast<double>(j.at("frames").size());
    model.pixels = j.at("image").at("width").number() * j.at("image").at("height").number();
    double busy_s = 0;
    for (const JsonView& node : j.at("nodes").elements()) busy_s += node.at("busy_s").number();
    model.pixel_time_s = busy_s / (model.pixels * frames);
    const JsonView traffic = j.at("traffic");
    model.code_bytes = traffic.at(name_of(Command::load_code)).at("bytes").number();
    double load_bytes = traffic.at(name_of(Command::load_data)).at("bytes").number();
    const double nodes = static_cast<double>(j.at("nodes").size());
    double assignment_bytes = traffic.at(name_of(Command::load_display_polygon)).at("bytes").number();
    if (const double stages = stages_of(j); stages > 0) {  // what was for zones is not of pictures
      const JsonView zones = j.at("zones");
      assignment_bytes -= zones.at("assignment_bytes").number();
      load_bytes -= zones.at("data_bytes").number();
      read_zones(j, stages, model.zones);
    }
    // A render without mpirun sends no scene, but a net would.
    model.data_bytes = std::max(load_bytes, j.at("scene").at("bytes").number());
    model.assignment_bytes = assignment_bytes / (frames * nodes);
    const JsonView cut = j.at("subpolygons");
    double subpolygons = cut.at("columns").number() * cut.at("rows").number();
    if (cut.has("small_rows"))
      subpolygons += cut.at("small_columns").number() * cut.at("small_rows").number();
    model.subpolygons_per_processor = subpolygons / nodes;
    if (j.at("wire").text() == "block")
      model.wires.push_back({"measured", traffic.at("bytes_per_pixel").number(), 0});
    if (!(model.pixel_time_s > 0)) throw InputError({path}, "the render traced nothing");
  } catch (const JsonError& e) {
    throw InputError(
        {path},
        fmt::format("not the statistics of a render ({}); `rayfarm render --stats` writes them", e.what()));
  }
}

int print_model(const ModelOptions& options) {
  NetModel model = options.model;
  for (const double bytes : options.wire_bytes)
    model.wires.push_back({fmt::format("{:g} bytes", bytes), bytes, 0});
  std::vector<WireModel> wires{{"pixel", kPixelBytes, 1}};
  if (model.wires.empty() || model.wires.front().name != "pixel") wires.push_back({"block", 3, 0});
  for (const WireModel& wire : model.wires)
    if (wire.name != "pixel") wires.push_back(wire);

  Table limits{"limits",
               {"wire", "bytes/pixel", "processors that fill the net", "that fill the frame buffer",
                "best for the first frame", "its speed-up"},
               {}};
  std::vector<double> processors = options.processors;
  if (processors.empty()) {
    for (double n = 1; n <= kMostProcessors; n *= 4) processors.push_back(n);
    for (const WireModel& wire : wires)
      if (const double n = std::floor(saturating_processors(model, wire)); n >= 1 && n <= kMostProcessors)
        processors.push_back(n);
    std::sort(processors.begin(), processors.end());
    processors.erase(std::unique(processors.begin(), processors.end()), processors.end());
  }
  std::vector<Table> tables;
  for (const WireModel& wire : wires) {
    const int best = best_processors(model, wire);
    limits.rows.push_back({wire.name, wire.bytes_per_pixel, std::floor(saturating_processors(model, wire)),
                           std::floor(frame_buffer_processors(model)), double(best),
                           std::floor(evaluate(model, wire, best).first_speedup)});
    Table table{
        "wire: " + wire.name,
        {"processors", "code_s", "data_s", "assignment_s", "results_s", "trace_s", "net_s", "frame_buffer_s",
         "first_frame_s", "next_frame_s", "first_speedup", "next_speedup", "net_use"},
        {}};
    for (const double n : processors) {
      const NetTimes t = evaluate(model, wire, n);
      table.rows.push_back({t.processors, t.code_s, t.data_s, t.assignment_s, t.results_s, t.trace_s, t.net_s,
                            t.frame_buffer_s, t.first_frame_s, t.next_frame_s, t.first_speedup,
                            t.next_speedup, t.net_use});
    }
    tables.push_back(std::move(table));
  }
  tables.insert(tables.begin(), limits);
  if (model.zones.zones > 0) {
    Table zones{"zones", {"processors", "data_s", "trace_s", "results_s", "all_s"}, {}};
    for (const double n : processors) {
      const ZonesTimes t = evaluate_zones(model, n);
      zones.rows.push_back({n, t.data_s, t.trace_s, t.results_s, t.total_s()});
    }
    tables.push_back(std::move(zones));
  }
  fmt::print("{}", format_tables(tables, options.format));
  return kComplete;
}

}  // namespace

void add_model_command(CommandLine& line) {
  const auto o = std::make_shared<ModelOptions>();
  NetModel& m = o->model;
  Verb verb;
  verb.name = "model";
  verb.help = "the thesis's model of the net: Equation 4.6 with its limits, for any numbers";
  verb.examples = {
      {"rayfarm model --preset thesis --processors 64,256,1024", "the thesis's net with more processors"}};
  verb.run = [o](const Renders&) { return print_model(*o); };
  Options options = line.add(std::move(verb));
  // These two set what other options change, whatever their order.
  options
      .word(
          "--preset", [&m](const std::string&) { m = thesis_model(); }, {"thesis"},
          "thesis: its numbers of section 4.4.4.2")
      .read_first();
  options
      .text(
          "--stats", [&m](const std::string& path) { read_statistics(path, m); },
          "take size, times and bytes from what `rayfarm render --stats` wrote", "FILE")
      .read_first();
  add_rate(options, m.rate_bit_per_s);
  options.number("--pixels", m.pixels, 1, 1e12, "of a frame (default: 1024 × 1024)");
  options
      .number("--pixel-time", m.pixel_time_s, 1e-15, 1e6,
              "seconds to trace a pixel on one processor (default: 0.04)")
      .takes("S");
  options.number("--code-bytes", m.code_bytes, 0, 1e15, "of code (default: 0)");
  options.number("--data-bytes", m.data_bytes, 0, 1e15, "of the scene (default: 0)");
  options.number("--copies", m.copies_per_processor, 0, 1,
                 "of code and data for each processor: 0 broadcasts them once, 1 sends them to one after the "
                 "other (default: 0)");
  options.number("--assignment-bytes", m.assignment_bytes, 0, 1e9,
                 "for each processor and frame (default: 0)");
  options.number("--subpolygons", m.subpolygons_per_processor, 1, 1e9, "per processor (default: 64)");
  options
      .number("--frame-buffer-time", m.frame_buffer_s, 0, 1e3,
              "seconds in which the host stores a pixel (default: 0, no limit)")
      .takes("S");
  options.numbers("--wire-bytes", o->wire_bytes, 1e-6, 1e6,
                  "bytes per pixel of further wires, whose messages are subpolygons; beside 9 (pixel) and 3 "
                  "(block)");
  options.number("--zones", m.zones.zones, 0, 1e12,
                 "that light is spread over before pictures (default: 0, none)");
  options.number("--rounds", m.zones.rounds, 1, 1e6, "of light from zone to zone (default: 1)");
  options.number("--zone-rays", m.zones.rays, 1, 1e15, "of a round (default: 1,000,000)");
  options
      .number("--zone-ray-time", m.zones.ray_time_s, 0, 1e6,
              "seconds to trace one of them on one processor (default: 0)")
      .takes("S");
  options.number("--zone-result-bytes", m.zones.result_bytes, 0, 1e15,
                 "of all processors in a round (default: 0)");
  options.numbers("--processors", o->processors, 1, 1e9, "1,2,4: rows of the table");
  add_format(options, o->format);
}

}  // namespace rayfarm
