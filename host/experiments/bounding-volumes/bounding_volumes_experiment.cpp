#include "host/experiments/bounding-volumes/bounding_volumes_experiment.h"

#include <fmt/core.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "host/experiments/bounding-volumes/bounding_page.h"
#include "host/experiments/bounding-volumes/weghorst_tables.h"
#include "host/experiments/page.h"
#include "host/experiments/plots.h"
#include "host/files/text_file.h"
#include "host/process/exit_code.h"

namespace rayfarm {
namespace {

// Theirs.
constexpr int kWidth_px = 256, kHeight_px = 240;
constexpr int kRuns = 3;

/// An item that fills a circle from the front and hardly anything from the side, as Figure 2 wants one: a rim
/// of 48 pieces, a quarter as thick as it is high. Frame 0 shows the front, frame 1 the side.
std::string wheel_yaml() {
  constexpr int kPieces = 48;
  constexpr double kOuter = 1, kInner = 0.93, kHalf = 0.25;
  const auto corner = [](double radius, int piece, double z) {
    const double turn = 2 * std::numbers::pi * piece / kPieces;
    return fmt::format("[{:.6f}, {:.6f}, {:.2f}]", radius * std::cos(turn), radius * std::sin(turn), z);
  };
  std::string text =
      "# An item whose best bounding volume depends on the view (Weghorst, Hooper and Greenberg 1984, Figure "
      "2):\n"
      "# a wheel, from the front (frame 0) and from the side (frame 1).\n"
      "view: {location: {0: [0, 0, 7], 1: [7, 0, 0]}, look_at: [0, 0, 0], field_of_view: 20, aspect: 1}\n"
      "lights: [{position: [2, 3, 9]}]\nbackground: [0.1, 0.1, 0.12]\nscene:\n  - name: wheel\n    group:\n";
  const auto quad = [&](const std::string& a, const std::string& b, const std::string& c,
                        const std::string& d) {
    text += fmt::format("      - {{polygon: {{points: [{}, {}, {}, {}]}}}}\n", a, b, c, d);
  };
  for (int i = 0; i < kPieces; ++i) {
    quad(corner(kOuter, i, -kHalf), corner(kOuter, i + 1, -kHalf), corner(kOuter, i + 1, kHalf),
         corner(kOuter, i, kHalf));
    quad(corner(kInner, i, kHalf), corner(kInner, i + 1, kHalf), corner(kInner, i + 1, -kHalf),
         corner(kInner, i, -kHalf));
    for (const double z : {-kHalf, kHalf})
      quad(corner(kInner, i, z), corner(kOuter, i, z), corner(kOuter, i + 1, z), corner(kInner, i + 1, z));
  }
  // The hub: a disk that fills the wheel.
  for (const double z : {-kHalf, kHalf}) {
    std::string points;
    for (int i = 0; i < kPieces; ++i) points += (i > 0 ? ", " : "") + corner(kInner, i, z);
    text += fmt::format("      - {{polygon: {{points: [{}]}}}}\n", points);
  }
  return text;
}

const char* const kPlots = R"(# gnuplot bounding_volumes.gp
set terminal svg size 900,440 font "sans,12" background "white"
set key outside right
set grid y
set yrange [0:*]
set style data histograms
set style fill solid 0.8
set output "totals.svg"
set title "Time relative to C here, and beside each in 1984"
set xtics rotate by -30
plot for [i=2:9] "totals.dat" using i:xtic(1) title columnheader(i)
set output "phases.svg"
set title "Phases of C and SHZ, relative to C's time"
set style histogram rowstacked
plot for [i=2:6] "phases.dat" using i:xtic(1) title columnheader(i)
)";

void write_plots(const std::filesystem::path& folder, const BoundingResults& results) {
  std::string totals = "environment C CZ CH CHZ S SZ SH SHZ\n",
              phases = "environment tree shadow buffer colour miscellaneous\n";
  for (size_t e = 0; e < results.environments.size(); ++e) {
    const EnvironmentRun& ours = results.environments[e];
    const weghorst::Environment& theirs = weghorst::kEnvironments[e];
    const double control = ours.runs[weghorst::kC].total_s();
    std::string here = fmt::format("\"{}\"", theirs.title), seed = "\"1984\"";
    for (size_t c = 0; c < ours.runs.size(); ++c) {
      here += fmt::format(" {:.4f}", ours.runs[c].total_s() / control);
      seed += fmt::format(" {:.4f}", theirs.total[c]);
    }
    totals += here + "\n" + (e < weghorst::kTableNine ? seed + "\n" : "");
    for (const size_t c : {weghorst::kC, weghorst::kSHZ}) {
      const CombinationRun& r = ours.runs[c];
      phases += fmt::format("\"{}, {}\" {:.4f} {:.4f} {:.4f} {:.4f} {:.4f}\n", theirs.title, r.name,
                            r.tree_s() / control, r.shadow.s / control, r.buffer_s / control,
                            r.colour_s() / control, r.write_s / control);
    }
  }
  write_text_file((folder / "totals.dat").string(), totals);
  write_text_file((folder / "phases.dat").string(), phases);
  draw_plots(folder, "bounding_volumes.gp", kPlots);
}

}  // namespace

int run_bounding_volumes_experiment(const ExperimentOptions& options) {
  const std::filesystem::path folder = make_page_folder(options.output),
                              scenes = std::filesystem::path(options.scenes) / "hierarchies";
  BoundingResults results;
  results.width_px = options.width_px > 0 ? options.width_px : kWidth_px;
  results.height_px = std::max(1, results.width_px * kHeight_px / kWidth_px);
  results.factors = measure_volume_factors(15);
  const std::string scratch = (folder / "scratch.png").string();
  for (const weghorst::Environment& environment : weghorst::kEnvironments) {
    fmt::print(stderr, "bounding-volumes: {}\n", environment.title);
    const SceneDescription scene = load_scene((scenes / (std::string(environment.scene) + ".yaml")).string());
    results.environments.push_back(run_environment(scene, environment.frame, environment.depth,
                                                   results.width_px, results.height_px, kRuns, scratch));
  }
  std::filesystem::remove(scratch);
  const std::string wheel = (folder / "wheel.yaml").string();
  write_text_file(wheel, wheel_yaml());
  const SceneDescription wheel_scene = load_scene(wheel);
  const auto look = [&](int frame) {
    return compare_bounds(wheel_scene, frame, results.width_px, results.width_px, kRuns);
  };
  results.front = look(0);
  results.side = look(1);
  for (const auto& [name, format] : {std::pair("bounding_volumes.csv", TableFormat::csv),
                                     std::pair("bounding_volumes.json", TableFormat::json)})
    write_text_file((folder / name).string(), format_tables({bounding_table(results)}, format));
  write_plots(folder, results);
  write_text_file((folder / "README.md").string(), bounding_page(results));
  fmt::print("{}\n", (folder / "README.md").string());
  return kComplete;
}

}  // namespace rayfarm
