#include "host/experiments/depth/depth_experiment.h"

#include <fmt/core.h>

#include <array>
#include <chrono>
#include <filesystem>

#include "host/experiments/page.h"
#include "host/experiments/pictures.h"
#include "host/experiments/plots.h"
#include "host/files/text_file.h"
#include "host/process/exit_code.h"
#include "host/render/render_options.h"

namespace rayfarm {
namespace {

namespace fs = std::filesystem;

/// Of each kind in the pictures that others are compared with.
constexpr uint32_t kDeepest = 24;

constexpr std::array kScenes{"mirrors", "glass", "both"};

struct Limits {
  uint32_t reflections, transmissions, depth;
};

/// A picture with some limits.
struct Measured {
  Limits limits;
  Difference error;
  double rays = 0, seconds = 0;  ///< over those of the deep picture
};

/// What is measured of all scenes: limits with the number that the row is about.
struct Series {
  const char* name;
  const char* title;
  std::vector<std::pair<std::string, Limits>> rows;
};

std::vector<Series> make_series() {
  Series reflections{"reflections", "Reflections", {}}, transmissions{"transmissions", "Transmissions", {}},
      depth{"depth", "Depth alone", {}};
  for (const uint32_t n : {0u, 1u, 2u, 3u, 4u, 5u, 6u, 7u, 8u, 10u, 12u, 14u, 16u, 20u}) {
    reflections.rows.push_back({fmt::format("{}", n), {n, kDeepest, 1 + n + kDeepest}});
    transmissions.rows.push_back({fmt::format("{}", n), {kDeepest, n, 1 + n + kDeepest}});
  }
  for (const uint32_t n : {1u, 2u, 3u, 4u, 5u, 6u, 7u, 8u, 9u, 10u, 12u, 14u, 17u, 21u})
    depth.rows.push_back({fmt::format("{}", n), {n - 1, n - 1, n}});
  Series together{"together",
                  "Limits together",
                  {{"--max-depth 5", {4, 4, 5}},
                   {"--max-depth 12", {11, 11, 12}},
                   {"4 and 7, the default", {4, 7, 12}},
                   {"5 and 7", {5, 7, 13}},
                   {"4 and 14", {4, 14, 19}},
                   {"5 and 14", {5, 14, 20}},
                   {"10 and 16", {10, 16, 27}}}};
  return {reflections, transmissions, depth, together};
}

/// A scene with its deep picture.
class DeepScene {
 public:
  DeepScene(const std::string& path, int width_px) : scene_(path, width_px) {
    deep_ = render({kDeepest, kDeepest, 1 + 2 * kDeepest}, seconds_);
  }

  Measured measure(const Limits& limits) const {
    Measured result{limits, {}, 0, 0};
    const FloatPicture picture = render(limits, result.seconds);
    result.seconds /= seconds_;
    result.error = difference(picture, deep_);
    result.rays = static_cast<double>(picture.counts.total()) / static_cast<double>(deep_.counts.total());
    return result;
  }

 private:
  FloatPicture render(const Limits& limits, double& seconds) const {
    RenderSettings settings;
    settings.max_reflections = limits.reflections;
    settings.max_transmissions = limits.transmissions;
    settings.max_depth = limits.depth;
    const auto begin = std::chrono::steady_clock::now();
    FloatPicture picture = scene_.render(settings);
    seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return picture;
  }

  PicturedScene scene_;
  double seconds_ = 0;
  FloatPicture deep_;
};

/// What was measured of one series: for each row one for each scene.
using Results = std::vector<std::array<Measured, kScenes.size()>>;

Table long_table(const std::vector<Series>& series, const std::vector<Results>& results) {
  Table table{"depth",
              {"series", "row", "scene", "reflections", "transmissions", "depth", "rms", "largest", "visible",
               "rays_ratio", "time_ratio"},
              {}};
  for (size_t s = 0; s < series.size(); ++s)
    for (size_t row = 0; row < series[s].rows.size(); ++row)
      for (size_t i = 0; i < kScenes.size(); ++i) {
        const Measured& m = results[s][row][i];
        table.rows.push_back({std::string(series[s].name), series[s].rows[row].first, std::string(kScenes[i]),
                              double(m.limits.reflections), double(m.limits.transmissions),
                              double(m.limits.depth), m.error.rms, m.error.largest, m.error.visible, m.rays,
                              m.seconds});
      }
  return table;
}

std::string page_table(const Series& series, const Results& results) {
  std::string out = "| limit |", line = "|---|";
  for (const char* scene : kScenes) {
    out += fmt::format(" {}: RMS | visible | rays |", scene);
    line += "---:|---:|---:|";
  }
  out += "\n" + line + "\n";
  for (size_t row = 0; row < series.rows.size(); ++row) {
    out += fmt::format("| {} |", series.rows[row].first);
    for (const Measured& m : results[row])
      out += fmt::format(" {:.2g} | {:.2f} % | {:.3f} |", m.error.rms, 100 * m.error.visible, m.rays);
    out += "\n";
  }
  return out;
}

const char* const kPlots = R"(# gnuplot depth.gp
set terminal svg size 760,420 font "sans,12" background "white"
set key right top
set grid
set logscale y
set format y "10^{%T}"
set yrange [1e-6:1]
set xrange [0:20]
set ylabel "RMS error"
set output "reflections.svg"
set xlabel "reflections on a branch, at most"
set title "What is missing behind a limit of reflections"
set arrow 1 from 4, graph 0 to 4, graph 1 nohead dt 2 lc 0
set arrow 2 from 5, graph 0 to 5, graph 1 nohead dt 2 lc 0
plot for [i=2:4] "reflections.dat" using 1:i with linespoints lc (i-1) title columnheader(i)
set output "transmissions.svg"
set xlabel "transmissions on a branch, at most"
set title "What is missing behind a limit of transmissions"
set arrow 1 from 7, graph 0 to 7, graph 1 nohead dt 2 lc 0
set arrow 2 from 14, graph 0 to 14, graph 1 nohead dt 2 lc 0
plot for [i=3:4] "transmissions.dat" using 1:i with linespoints lc (i-1) title columnheader(i)
)";

void write_plots(const fs::path& folder, const std::vector<Series>& series,
                 const std::vector<Results>& results) {
  for (const size_t s : {0, 1}) {
    std::string data = "limit";
    for (const char* scene : kScenes) data += fmt::format(" {}", scene);
    data += "\n";
    for (size_t row = 0; row < series[s].rows.size(); ++row) {
      data += series[s].rows[row].first;
      for (const Measured& m : results[s][row]) data += fmt::format(" {:.4g}", m.error.rms);
      data += "\n";
    }
    write_text_file((folder / fmt::format("{}.dat", series[s].name)).string(), data);
  }
  draw_plots(folder, "depth.gp", kPlots);
}

std::string page_text(const std::vector<Series>& series, const std::vector<Results>& results) {
  const auto at = [&](size_t s, const char* row, size_t scene) -> const Measured& {
    const auto& rows = series[s].rows;
    for (size_t i = 0; i < rows.size(); ++i)
      if (rows[i].first == row) return results[s][i][scene];
    return results[s].front()[scene];
  };
  const auto said = [&](size_t s, const char* row, size_t scene) {
    const Measured& m = at(s, row, scene);
    return fmt::format("{:.2g} ({:.1f} % of the pixels differ visibly)", m.error.rms, 100 * m.error.visible);
  };
  std::string text = fmt::format(
      "# Depth: how far light is to be followed\n\nWritten by `rayfarm experiment depth`; `deploy/reproduce "
      "depth` runs it again. The thesis (2.3.4): \"after about four or five reflections or about seven "
      "transparent objects there is little more additional information to be obtained\". Three scenes "
      "(`scenes/depth`) in Whitted's model, one ray per pixel, against pictures with {0} reflections and {0} "
      "transmissions on each branch of the lighting tree. RMS is of linear values, of which 1 is white; "
      "visible "
      "is the share of pixels that differ by more than 1/255 in a channel; rays are over those of the deep "
      "picture. Total internal reflection is a reflection.\n\n",
      kDeepest);
  for (const char* scene : kScenes) text += fmt::format("![{0}]({0}.png) ", scene);
  text += fmt::format(
      "\n\nMirrors, glass and both with the default limits, 4 reflections and 7 transmissions.\n\n## What "
      "holds\n\n- Reflections: in a room of mirrors that reflect 88 % four leave an RMS error of {}, five "
      "{}, ten "
      "{}. With both, where less comes back, four leave {}, five {}.\n- Transparent objects: through the "
      "panes, "
      "which pass 92 % at each of their two surfaces, seven surfaces leave {}; seven objects, fourteen "
      "surfaces, "
      "{}. With both, seven surfaces leave {}, fourteen {}. A limit of seven is about objects that a ray "
      "passes "
      "once, like a sheet without thickness; for bodies `--max-transmissions 14` says the same.\n- A depth "
      "for all "
      "kinds together of 5 leaves {} in glass and {} with both; the two limits leave {} and {}, for {:.2f} "
      "and "
      "{:.2f} times the rays.\n\n",
      said(0, "4", 0), said(0, "5", 0), said(0, "10", 0), said(0, "4", 2), said(0, "5", 2), said(1, "7", 1),
      said(1, "14", 1), said(1, "7", 2), said(1, "14", 2), said(3, "--max-depth 5", 1),
      said(3, "--max-depth 5", 2), said(3, "4 and 7, the default", 1), said(3, "4 and 7, the default", 2),
      at(3, "4 and 7, the default", 1).rays / at(3, "--max-depth 5", 1).rays,
      at(3, "4 and 7, the default", 2).rays / at(3, "--max-depth 5", 2).rays);
  text += "![reflections](reflections.svg)\n\n![transmissions](transmissions.svg)\n\n";
  for (size_t s = 0; s < series.size(); ++s)
    text += fmt::format("## {}\n\n{}\n", series[s].title, page_table(series[s], results[s]));
  text +=
      "In `Reflections` transmissions are as in the deep picture, in `Transmissions` reflections are. "
      "Nothing in `mirrors` transmits. `depth.csv` has all numbers, with times.\n";
  return text;
}

}  // namespace

int run_depth_experiment(const ExperimentOptions& options, const RunRender& render) {
  const fs::path folder = make_page_folder(options.output);
  const std::vector<Series> series = make_series();
  std::vector<Results> results(series.size());
  for (size_t s = 0; s < series.size(); ++s) results[s].resize(series[s].rows.size());
  for (size_t i = 0; i < kScenes.size(); ++i) {
    fmt::print(stderr, "depth: {}\n", kScenes[i]);
    const std::string path =
        (fs::path(options.scenes) / "depth" / (std::string(kScenes[i]) + ".yaml")).string();
    const DeepScene scene(path, options.width_px);
    for (size_t s = 0; s < series.size(); ++s)
      for (size_t row = 0; row < series[s].rows.size(); ++row)
        results[s][row][i] = scene.measure(series[s].rows[row].second);
    RenderOptions job;
    job.scene = path;
    job.output = (folder / (std::string(kScenes[i]) + ".png")).string();
    job.settings.samples = 9;
    if (options.width_px > 0) job.size_px = {options.width_px, std::max(1, options.width_px * 3 / 4)};
    job.is_quiet = true;
    if (const int code = render(job); code != kComplete) return code;
  }
  write_text_file((folder / "depth.csv").string(),
                  format_tables({long_table(series, results)}, TableFormat::csv));
  write_plots(folder, series, results);
  write_text_file((folder / "README.md").string(), page_text(series, results));
  fmt::print("{}\n", (folder / "README.md").string());
  return kComplete;
}

}  // namespace rayfarm
