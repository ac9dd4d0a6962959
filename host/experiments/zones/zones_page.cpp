#include "host/experiments/zones/zones_page.h"

#include <fmt/core.h>

#include "host/experiments/plots.h"
#include "host/files/text_file.h"

namespace rayfarm {
namespace {

const char* const kPlots = R"gp(# gnuplot zones.gp
set terminal svg size 760,420 font "sans,12" background "white"
set grid
set key outside right
set logscale xy 10
set format y "10^{%T}"
set output "error_size.svg"
set xlabel "size of zones"
set ylabel "RMS of blocks over the mean"
set title "Error against paths over the size of zones (lines: Goral's room; dashes: closed)"
plot for [i=0:1] for [v=0:3] "error_size.dat" index i using 1:(column(v+2)) with linespoints pt (i == 0 ? 7 : 6) \
     dt i+1 lc v+1 title (i == 0 ? word("flat smooth direct gather", v+1) : "")
set output "error_rays.svg"
set xlabel "rays of the first round"
set title "Error against paths over rays (lines: Goral's room; dashes: closed)"
plot for [i=0:1] for [v=0:3] "error_rays.dat" index i using 1:(column(v+2)) with linespoints pt (i == 0 ? 7 : 6) \
     dt i+1 lc v+1 title (i == 0 ? word("flat smooth direct gather", v+1) : "")
set output "unsent_rays.svg"
unset logscale x
set key inside right top
set xlabel "rays"
set ylabel "unsent, of all power"
set title "Unsent power over rays"
array names[4] = ["Goral's room, all zones at a time", "the fullest zone", "closed, all", "closed, the fullest"]
plot for [i=0:3] "rounds.dat" index i using 2:3 with linespoints pt 7 ps (i % 2 == 0 ? 0.7 : 0) lc i+1 title names[i+1]
set output "unsent_rounds.svg"
set logscale x 10
set xlabel "rounds"
set title "Unsent power over rounds"
plot for [i=0:3] "rounds.dat" index i using 1:3 with linespoints pt 7 ps (i % 2 == 0 ? 0.7 : 0) lc i+1 title names[i+1]
set output "costs.svg"
set key outside right
set xlabel "CPU seconds, the light of zones included"
set ylabel "RMS of pixels over the mean"
set title "Noise over CPU seconds, Goral's room"
plot for [i=0:13] "costs.dat" index i using 1:2 with linespoints pt 7 lc i+1 title columnheader(1), 0.01 lc 0 title "asked"
set output "ranks.svg"
set key inside right top
set xlabel "nodes"
set ylabel "seconds"
set title "Time of the light of zones over nodes"
plot "ranks.dat" using 1:2 with points pt 7 ps 1.2 lc 1 title "measured", "" using 1:3 with lines lc 1 title "model, no net", \
     "" using 1:4 with lines lc 2 title "model, 1 Gbit/s", "" using 1:5 with lines lc 3 title "model, 8 Mbit/s"
)gp";

std::string checks_text(const std::vector<ZoneStudy>& studies) {
  std::string text = "| what | asked | reached | |\n|---|---|---|---|\n";
  for (const ZoneStudy& study : studies)
    for (const ZoneCheck& check : study.checks)
      text += fmt::format("| {} | {} | {} | {} |\n", check.what, check.asked, check.reached,
                          check.holds ? "yes" : "**no**");
  return text;
}

}  // namespace

void write_zones_page(const ZoneWork& work, const std::vector<ZoneStudy>& studies) {
  std::vector<Table> tables{{"checks", {"what", "asked", "reached", "holds"}, {}}};
  std::string sections;
  std::map<std::string, std::string> data;
  for (const ZoneStudy& study : studies) {
    sections += study.section;
    tables.insert(tables.end(), study.tables.begin(), study.tables.end());
    for (const ZoneCheck& check : study.checks)
      tables[0].rows.push_back({check.what, check.asked, check.reached, check.holds ? 1.0 : 0.0});
    for (const auto& [file, text] : study.data) data[file] += text;
  }
  for (const auto& [file, text] : data) write_text_file(work.file(file).string(), text);
  write_text_file(work.file("zones.csv").string(), format_tables(tables, TableFormat::csv));
  write_text_file(work.file("zones.json").string(), format_tables(tables, TableFormat::json));
  draw_plots(work.file(""), "zones.gp", kPlots);
  write_text_file(
      work.file("README.md").string(),
      "# Zones: light that surfaces and media keep\n\n"
      "Written by `rayfarm experiment zones` (`deploy/reproduce zones`). Zones are the method of the "
      "thesis's "
      "2.2.5 (Goral, Cohen) as Shirley, Sung and Brown (1991, sections 3 and 4) have it, progressive "
      "refinement "
      "by rays; neither states a number of zones, rays or a time, so this page states its own. Times are "
      "processor seconds of all threads, and mean something only as ratios.\n\n"
      "## What is asked, and what was reached\n\n" +
          checks_text(studies) + sections);
}

}  // namespace rayfarm
