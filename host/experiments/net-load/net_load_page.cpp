#include "host/experiments/net-load/net_load_page.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "host/experiments/page.h"
#include "host/experiments/plots.h"
#include "host/files/text_file.h"
#include "host/instrument/model.h"
#include "host/instrument/simulator.h"

namespace rayfarm {
namespace {

namespace fs = std::filesystem;

/// Where the measured curve bends: the work of all processors over the time that the full net takes.
struct Knee {
  double measured = 0, model = 0, link_model = 0;
};

std::vector<const NetRun*> runs_of(const NetLoadPage& page, const std::string& wire) {
  std::vector<const NetRun*> runs;
  for (const NetRun& run : page.runs)
    if (run.wire == wire) runs.push_back(&run);
  return runs;
}

Knee find_knee(const NetLoadPage& page, const std::string& wire) {
  const auto runs = runs_of(page, wire);
  const NetRun &few = *runs.front(), &many = *runs.back();
  Knee knee;
  const double work = few.frame_s * few.processors;
  knee.measured = work / many.frame_s;
  knee.model = work / many.model_s;
  knee.link_model = work / many.link_model_s;
  return knee;
}

Table runs_table(const NetLoadPage& page) {
  Table table{"runs",
              {"wire", "processors", "rate_bit_per_s", "frame_s", "model_s", "link_model_s", "simulated_s",
               "metered_bytes_per_pixel", "link_bytes_per_pixel", "net_use", "idle", "host_cpu_s"},
              {}};
  for (const NetRun& r : page.runs)
    table.rows.push_back({r.wire, double(r.processors), r.rate_bit_per_s, r.frame_s, r.model_s,
                          r.link_model_s, r.simulated_s, r.metered_bytes_per_pixel, r.link_bytes_per_pixel,
                          r.net_use, r.idle, r.host_cpu_s});
  return table;
}

Table balance_table(const NetLoadPage& page) {
  Table table{"balance", {"case", "seconds", "simulated_s", "efficiency"}, {}};
  for (const BalanceRun& r : page.balance)
    table.rows.push_back({r.name, r.seconds, r.simulated_s, r.efficiency});
  return table;
}

/// A net and processors of some year.
struct Era {
  const char* name;
  int width_px, height_px;
  double pixel_s, rate_bit_per_s, compressed_bytes;
  int frames;
};
/// Of balls.nff at 1024 × 1024 (README).
constexpr double kCompressedBytes = 0.59;
const Era kEras[] = {
    {"1985: 0.04 s a pixel, 8 Mbit/s, 1024 x 1024", 1024, 1024, 0.04, 8e6, kCompressedBytes, 4},
    {"today: 4 us a pixel (1 us a ray), 10 Gbit/s, 3840 x 2160", 3840, 2160, 4e-6, 10e9, kCompressedBytes,
     1}};

struct FormName {
  const char* name;
  ResultForm form;
};
const FormName kForms[] = {
    {"pixel", ResultForm::pixels}, {"block", ResultForm::blocks}, {"compressed", ResultForm::compressed}};

Simulation simulation_of(const Era& era, ResultForm form, int processors) {
  Simulation s;
  s.processors = processors;
  s.form = form;
  s.messages_held = 2;
  s.frames = s.frames_open = era.frames;
  s.rate_bit_per_s = era.rate_bit_per_s;
  s.cost.width_px = era.width_px;
  s.cost.height_px = era.height_px;
  s.cost.pixel_s = {era.pixel_s};
  s.cost.pixel_bytes = {era.compressed_bytes};
  s.least_side_px = least_side_of(form);
  return s;
}

Table extrapolation() {
  Table table{"beyond", {"era", "wire", "processors", "frame_s", "speedup", "net_use"}, {}};
  for (const Era& era : kEras)
    for (const FormName& form : kForms)
      for (const int n : {16, 64, 256, 1024, 2048, 4444, 8192, 16383}) {
        const Simulation s = simulation_of(era, form.form, n);
        const SimulationResult r = simulate(s);
        table.rows.push_back({std::string(era.name), std::string(form.name), double(n), r.frame_s,
                              r.busy_s / s.frames / r.frame_s, r.net_use});
      }
  return table;
}

/// What the thesis leaves to further work: several nets, several frame buffers, rotation.
Table further_work() {
  Table table{"further work", {"case", "processors", "frame_s", "speedup", "efficiency"}, {}};
  const auto add = [&table](const char* name, const Simulation& s) {
    const SimulationResult r = simulate(s);
    table.rows.push_back(
        {std::string(name), double(s.processors), r.frame_s, r.busy_s / s.frames / r.frame_s, r.efficiency});
  };
  Simulation s = simulation_of(kEras[0], ResultForm::pixels, 8888);
  add("one net, 9 bytes a pixel", s);
  s.nets = 2;
  add("two nets", s);
  s.frame_buffer_s = 9e-6;
  add("two nets, one frame buffer of 9 us a pixel", s);
  s.frame_buffers = 2;
  add("two nets, two such frame buffers", s);
  s = simulation_of(kEras[0], ResultForm::compressed, 4444);
  s.cost.columns = s.cost.rows = 16;  // a hard corner: 1/256 of the picture takes 20 times as long
  s.cost.pixel_s.assign(256, 0.04);
  s.cost.pixel_s[0] = 0.8;
  s.cost.pixel_bytes.assign(256, kCompressedBytes);
  s.frames = 8;
  s.frames_open = 8;
  s.subpolygons_per_processor = 1;
  s.rotates = false;
  add("hard corner, N subpolygons, no rotation", s);
  s.rotates = true;
  add("hard corner, N subpolygons, rotation over 8 frames", s);
  s.subpolygons_per_processor = 64;
  s.rotates = false;
  add("hard corner, 64 N subpolygons, no rotation", s);
  return table;
}

const char* const kPlots = R"(# gnuplot net_load.gp
set terminal svg size 760,420 font "sans,12" background "white"
set key right top
set grid
set output "knee.svg"
set logscale xy 2
set xrange [3.5:36]
set yrange [3:20]
set xlabel "processors"
set ylabel "frame, seconds"
set title "A frame on the virtual cluster, on nets that 12 processors fill"
plot "knee.dat" index 0 using 1:2 with points pt 7 lc 1 title "pixel wire, measured", \
     "" index 0 using 1:3 with lines lc 1 title "model, bytes on the links", \
     "" index 1 using 1:2 with points pt 5 lc 2 title "block wire on a third of the rate, measured", \
     "" index 1 using 1:3 with lines lc 2 dt 2 title "model"
set output "use.svg"
unset logscale
set xrange [*:*]
set yrange [0:1.6]
set xlabel "seconds since the first ray"
set ylabel "share of the net's rate"
set title "The net's use over time, pixel wire"
plot "use.dat" index 0 using 1:2 with steps lc 1 title "8 processors", \
     "" index 1 using 1:2 with steps lc 2 title "18 processors", \
     "" index 2 using 1:2 with steps lc 3 title "32 processors"
set output "beyond.svg"
set logscale xy 10
set xrange [10:20000]
set yrange [10:20000]
set key left top
set xlabel "processors"
set ylabel "speed-up"
set title "Simulated, with the numbers of 1985: 0.04 s a pixel, 8 Mbit/s, 1024 x 1024"
plot "beyond.dat" index 0 using 1:2 with linespoints lc 1 title "pixel wire, 9 bytes", \
     "" index 1 using 1:2 with linespoints lc 2 title "block wire, 3 bytes", \
     "" index 2 using 1:2 with linespoints lc 3 title "compressed, 0.59 bytes", \
     "+" using (4444):(4444) every ::0::0 with points pt 3 ps 2 lc 0 title "the thesis: 4,444"
set output "rays.svg"
unset logscale
set xrange [*:*]
set yrange [0:100]
set key outside right
set style data histograms
set style histogram rowstacked title offset 0,-1.5
set style fill solid 0.8 border -1
set boxwidth 0.6
set bmargin 5
set xtics rotate by -25
set xlabel ""
set ylabel "share, %"
set title "Left: rays by kinds; right: eye rays by the types of Figure 4.6"
plot newhistogram "kinds", "rays.dat" using 2:xtic(1) title "primary", "" using 3 title "shadow", \
     "" using 4 title "reflected", "" using 5 title "transmitted", \
     newhistogram "types" at 5, "rays.dat" using 7:xtic(1) title "type 1", "" using 8 title "type 2", "" using 9 title "type 3"
)";

void write_plots(const NetLoadPage& page, const Table& beyond, const fs::path& folder) {
  std::string knee;
  for (const char* wire : {"pixel", "block"}) {
    for (const NetRun* r : runs_of(page, wire))
      knee += fmt::format("{} {} {}\n", r->processors, r->frame_s, r->link_model_s);
    knee += "\n\n";
  }
  std::string use;
  for (const NetRun* r : runs_of(page, "pixel")) {
    if (r->processors != 8 && r->processors != 18 && r->processors != 32) continue;
    for (size_t i = 0; i < r->use_over_time.size(); ++i)
      use += fmt::format("{:.2f} {:.4f}\n", r->use_begin_s + static_cast<double>(i) * r->use_step_s,
                         r->use_over_time[i]);
    use += "\n\n";
  }
  std::string curves;
  std::string wire;
  for (const auto& row : beyond.rows) {
    if (std::get<std::string>(row[0]) != kEras[0].name) continue;
    if (!wire.empty() && wire != std::get<std::string>(row[1])) curves += "\n\n";
    wire = std::get<std::string>(row[1]);
    curves += fmt::format("{} {}\n", std::get<double>(row[2]), std::get<double>(row[4]));
  }
  write_text_file((folder / "knee.dat").string(), knee);
  write_text_file((folder / "use.dat").string(), use);
  write_text_file((folder / "beyond.dat").string(), curves);
  write_text_file((folder / "rays.dat").string(), ray_shares_data(page.rays));
  draw_plots(folder, "net_load.gp", kPlots);
}

std::string page_text(const NetLoadPage& page, const Table& beyond, const Table& further) {
  const NetModel thesis = thesis_model();
  const NetTimes t = evaluate(thesis, thesis.wires.front(), 4444);
  Simulation sim = simulation_of(kEras[0], ResultForm::pixels, 4444);
  sim.messages_held = 1;
  sim.frames = sim.frames_open = 1;
  sim.load_bytes = thesis.code_bytes + thesis.data_bytes;
  const SimulationResult simulated = simulate(sim);
  std::string text = fmt::format(
      "# The net: processors against load\n\nWritten by `rayfarm experiment net-load` (as root; {:.0f} "
      "pixels of {:.3g} s each on one emulated processor). `deploy/reproduce net` runs it again.\n\n## The "
      "thesis's figures\n\n| | thesis | model | simulation |\n|---|---:|---:|---:|\n| processors that fill "
      "the net | 4,444 | {:.0f} | |\n| first frame | 9.92 s | {:.2f} s | {:.2f} s |\n| next frames | 9.4 s | "
      "{:.1f} s | {:.1f} s |\n| speed-up, first frame | 4,228 | {:.0f} | {:.0f} |\n| speed-up, next frames | "
      "4,444 | {:.0f} | {:.0f} |\n\nThe simulation's processors wait for the net and hold no second pixel; "
      "`rayfarm simulate --processors 4444 --load-bytes 441424`.\n\n",
      page.pixels, page.pixel_time_s, std::floor(saturating_processors(thesis, thesis.wires.front())),
      t.first_frame_s, simulated.first_frame_s, t.next_frame_s, simulated.frame_s,
      std::floor(t.first_speedup), simulated.busy_s / simulated.first_frame_s, t.next_speedup,
      simulated.busy_s / simulated.frame_s);
  text +=
      "## Loading\n\nThe thesis broadcasts code and data once, to all, in the time of one copy. MPI sends a "
      "copy to "
      "every machine, by a way that Open MPI chooses or `OMPI_MCA_coll_tuned_bcast_algorithm` sets: from the "
      "host to one "
      "node after the other, along a tree, or along a chain. On a medium that all share no way saves "
      "anything, and "
      "every copy takes its time; through a switch copies travel at once. Eight megabit a second carry a "
      "megabyte.\n\n"
      "| nodes | net | way | bytes | seconds | copies' worth of time |\n|---:|---|---|---:|---:|---:|\n";
  for (const LoadRun& r : page.loads)
    text += fmt::format("| {} | {} | {} | {:.0f} | {:.2f} | {:.2f} |\n", r.nodes, r.net, r.way, r.bytes,
                        r.seconds, r.seconds / (r.bytes * 1e-6));
  text +=
      "\n## Where the net is full\n\nOne shared half-duplex medium. For the pixel and the block wire its "
      "rate is such that by the model 12 processors fill it. `model` takes the wire's own bytes (9, 3, or as "
      "compressed), `link model` those that the links counted: with headers, acknowledgements and control "
      "messages.\n\n![knee](knee.svg)\n\n| wire | knee, measured | model | link model | measured / link "
      "model |\n|---|---:|---:|---:|---:|\n";
  for (const char* wire : {"pixel", "block"}) {
    const Knee knee = find_knee(page, wire);
    text += fmt::format("| {} | {:.1f} | {:.1f} | {:.1f} | {:.3f} |\n", wire, knee.measured, knee.model,
                        knee.link_model, knee.measured / knee.link_model);
  }
  const NetRun &pixel = *runs_of(page, "pixel, large").back(),
               &equal = *runs_of(page, "compressed, large").back();
  text += fmt::format(
      "\nAt twice the resolution (`large`), on one net that by the model 12 processors with the pixel wire "
      "fill: the compressed wire moves {:.2f} bytes a pixel on the links where the pixel wire moves {:.2f}, "
      "so the net has room for {:.1f} times the processors. With 32 of them its frame takes {:.2f} s, the "
      "pixel wire's {:.2f} s.\n\n",
      equal.link_bytes_per_pixel, pixel.link_bytes_per_pixel,
      pixel.link_bytes_per_pixel / equal.link_bytes_per_pixel, equal.frame_s, pixel.frame_s);
  text += markdown(runs_table(page));
  double worst = 0;
  for (const NetRun& r : page.runs) worst = std::max(worst, std::abs(r.simulated_s / r.frame_s - 1));
  text += fmt::format(
      "\n![the net's use over time](use.svg)\n\nThe simulator is driven by each run's own cost map, and by "
      "the bytes that its links added to a packet; its largest error in a frame's time is {:.1f} %.\n\n## "
      "Balance\n\nEight emulated processors without a "
      "net. Efficiency is useful work over processors × time (a processor at half speed counts half). Idle "
      "nodes of the farm help with what another has held for a second, which the simulator's don't: where N "
      "subpolygons meet a hard corner.\n\n",
      100 * worst);
  text += markdown(balance_table(page));
  text += sizes_text(page.sizes);
  text += ray_shares_text(page.rays);
  text +=
      "\n## Beyond\n\nSimulated: four frames with rotation for 1985, one for today. Processors may hold one "
      "message "
      "while they trace the next.\n\n![beyond](beyond.svg)\n\n" +
      markdown(beyond) + "\nWhat the thesis leaves to further work, with its numbers:\n\n" +
      markdown(further);
  return text;
}

}  // namespace

void write_net_load_page(const NetLoadPage& page, const std::string& output) {
  const fs::path folder(output);
  const Table beyond = extrapolation(), further = further_work();
  const std::vector<Table> tables{runs_table(page), balance_table(page), beyond, further};
  write_text_file((folder / "net_load.csv").string(), format_tables(tables, TableFormat::csv));
  write_text_file((folder / "net_load.json").string(), format_tables(tables, TableFormat::json));
  write_plots(page, beyond, folder);
  write_text_file((folder / "README.md").string(), page_text(page, beyond, further));
}

}  // namespace rayfarm
