#include "host/experiments/sampling/sampling_page.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "host/experiments/page.h"
#include "host/experiments/plots.h"
#include "host/files/text_file.h"

namespace rayfarm {
namespace {

namespace fs = std::filesystem;

double mean(const ErrorsOfSeeds& errors) {
  return std::accumulate(errors.begin(), errors.end(), 0.0) / static_cast<double>(errors.size());
}

/// Standard deviation over the seeds; 0 for one.
double spread(const ErrorsOfSeeds& errors) {
  if (errors.size() < 2) return 0;
  const double middle = mean(errors);
  double sum = 0;
  for (const double e : errors) sum += (e - middle) * (e - middle);
  return std::sqrt(sum / static_cast<double>(errors.size() - 1));
}

/// A smaller mean that is no chance: by more than twice the standard error of the difference.
bool is_clearly_below(const ErrorsOfSeeds& a, const ErrorsOfSeeds& b) {
  const auto variance = [](const ErrorsOfSeeds& errors) {
    return spread(errors) * spread(errors) / static_cast<double>(errors.size());
  };
  return mean(b) - mean(a) > 2 * std::sqrt(variance(a) + variance(b));
}

size_t find(const std::vector<std::string>& names, const char* name) {
  return static_cast<size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

/// How often a pattern is the most accurate of the first `patterns` in a scene at a number of samples above
/// one, and how often clearly so.
struct Wins {
  int all = 0, clear = 0;
};
std::vector<Wins> count_wins(const SamplingPage& page, size_t patterns) {
  std::vector<Wins> wins(patterns);
  for (const SampledScene& scene : page.scenes)
    for (size_t n = 0; n < page.samples.size(); ++n) {
      if (page.samples[n] < 2) continue;
      size_t best = 0;
      for (size_t p = 1; p < patterns; ++p)
        if (mean(scene.errors[p][n]) < mean(scene.errors[best][n])) best = p;
      ++wins[best].all;
      bool is_clear = true;
      for (size_t p = 0; p < patterns; ++p)
        is_clear = is_clear && (p == best || is_clearly_below(scene.errors[best][n], scene.errors[p][n]));
      wins[best].clear += is_clear ? 1 : 0;
    }
  return wins;
}

/// Geometric mean of n-rooks' error over another pattern's, for `least` … `most` samples per pixel.
double rooks_ratio(const SamplingPage& page, const SampledScene& scene, size_t other, uint32_t least,
                   uint32_t most) {
  const size_t rooks = find(page.patterns, "n-rooks");
  double sum = 0;
  int count = 0;
  for (size_t n = 0; n < page.samples.size(); ++n) {
    if (page.samples[n] < least || page.samples[n] > most) continue;
    sum += std::log(mean(scene.errors[rooks][n]) / mean(scene.errors[other][n]));
    ++count;
  }
  return count > 0 ? std::exp(sum / count) : 1;
}

/// The power of n with which the error falls: a line through logarithms from four samples on, without 17.
double slope(const SamplingPage& page, const std::vector<ErrorsOfSeeds>& errors) {
  double count = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (size_t n = 0; n < page.samples.size(); ++n) {
    if (page.samples[n] < 4 || page.samples[n] == 17) continue;
    const double log_n = std::log(page.samples[n]), log_error = std::log(mean(errors[n]));
    count += 1;
    x += log_n;
    y += log_error;
    xx += log_n * log_n;
    xy += log_n * log_error;
  }
  const double divisor = count * xx - x * x;
  return divisor > 0 ? (count * xy - x * y) / divisor : 0;
}

std::string header(const SamplingPage& page, const std::string& first) {
  std::string out = "| " + first + " |", line = "|---|";
  for (const std::string& pattern : page.patterns) {
    out += " " + pattern + " |";
    line += "---:|";
  }
  return out + "\n" + line + "\n";
}

std::string wins_text(const SamplingPage& page) {
  const std::vector<Wins> then = count_wins(page, SamplingPage::kContemporaries),
                          today = count_wins(page, page.patterns.size());
  const int cells =
      std::accumulate(then.begin(), then.end(), 0, [](int sum, const Wins& wins) { return sum + wins.all; });
  std::string text =
      fmt::format(
          "Most accurate, of {} cases (six scenes, each number of samples above one); in brackets, by "
          "more than twice the standard error over the seeds:\n\n",
          cells) +
      header(page, "among");
  text += "| the paper's five |";
  for (size_t p = 0; p < page.patterns.size(); ++p)
    text += p < then.size() ? fmt::format(" {} ({}) |", then[p].all, then[p].clear) : " |";
  text += "\n| all |";
  for (const Wins& wins : today) text += fmt::format(" {} ({}) |", wins.all, wins.clear);
  return text + "\n\n";
}

std::string ratios_text(const SamplingPage& page) {
  std::string text =
      "N-rooks' error over the others', geometric mean over 2 to 8 and over 32 and more samples; below 1 "
      "n-rooks is more accurate:\n\n" +
      header(page, "scene, samples");
  for (const SampledScene& scene : page.scenes)
    for (const auto& [name, least, most] : {std::tuple{"2–8", 2u, 8u}, std::tuple{"32–", 32u, ~0u}}) {
      if (page.samples.back() < least) continue;
      text += fmt::format("| {}, {} |", scene.name, name);
      for (size_t p = 0; p < page.patterns.size(); ++p)
        text += fmt::format(" {:.2f} |", rooks_ratio(page, scene, p, least, most));
      text += "\n";
    }
  return text + "\n";
}

std::string slopes_text(const SamplingPage& page) {
  std::string text =
      "The power of n with which the error falls, from four samples on (random samples: -0.5):\n\n" +
      header(page, "scene");
  for (const SampledScene& scene : page.scenes) {
    text += "| " + scene.name + " |";
    for (const auto& errors : scene.errors) text += fmt::format(" {:.2f} |", slope(page, errors));
    text += "\n";
  }
  return text + "\n";
}

/// Sixteen samples against seventeen, which has no factors.
std::string factors_text(const SamplingPage& page) {
  const auto at = std::find(page.samples.begin(), page.samples.end(), 17);
  if (at == page.samples.end()) return "";
  const auto n = static_cast<size_t>(at - page.samples.begin());
  std::string text = "The error with 17 samples over that with 16:\n\n" + header(page, "scene");
  for (const SampledScene& scene : page.scenes) {
    text += "| " + scene.name + " |";
    for (const auto& errors : scene.errors)
      text += fmt::format(" {:.2f} |", mean(errors[n]) / mean(errors[n - 1]));
    text += "\n";
  }
  return text + "\n";
}

std::string claims_text(const SamplingPage& page) {
  const size_t rooks = find(page.patterns, "n-rooks"), jittered = find(page.patterns, "jittered"),
               regular = find(page.patterns, "regular");
  const std::vector<Wins> then = count_wins(page, SamplingPage::kContemporaries);
  int cells = 0;
  for (const Wins& wins : then) cells += wins.all;
  double extreme = 0;
  std::string where;
  for (const SampledScene& scene : page.scenes)
    for (size_t n = 0; n < page.samples.size(); ++n) {
      if (page.samples[n] < 2) continue;
      const double ratio = mean(scene.errors[regular][n]) / mean(scene.errors[jittered][n]);
      if (ratio <= extreme) continue;
      extreme = ratio;
      where = fmt::format("{}, {} samples", scene.name, page.samples[n]);
    }
  return fmt::format(
      "- \"N-rooks … has so far almost always been more accurate than other sampling methods on the images "
      "we "
      "have tested\": in {} of {} cases here it is the most accurate of the paper's five, clearly in {}.\n"
      "- \"Jittering may not be the best simple sampling strategy\": it is the best of the five in {} of {} "
      "cases, clearly in {}. `jittered` takes the same cell in every "
      "dimension, so that errors of lenses and lamps stop falling; Cook's uncorrelated jittering links "
      "cells at random.\n"
      "- N-rooks \"performs well for pixels containing horizontal or vertical edges, because it fully "
      "jitters "
      "each dimension\": its error over jittering's is {:.2f} there, from 2 samples on, and {:.2f} for edges "
      "in "
      "all directions.\n"
      "- \"Regular sampling can cause extreme aliasing\": its error is up to {:.1f} times jittering's ({}).\n"
      "- \"Jittering requires n to be a perfect square for optimum performance, or requires some factoring "
      "system "
      "otherwise (n = 17 would imply a 1 by 17 sampling partition)\": see 17 against 16 below.\n\n",
      then[rooks].all, cells, then[rooks].clear, then[jittered].all, cells, then[jittered].clear,
      rooks_ratio(page, page.scenes[0], jittered, 2, ~0u),
      rooks_ratio(page, page.scenes[1], jittered, 2, ~0u), extreme, where);
}

std::string page_text(const SamplingPage& page) {
  const size_t seeds = page.scenes.front().errors.front().front().size();
  std::string text = fmt::format(
      "# Sampling: how accurate the patterns are\n\nWritten by `rayfarm experiment sampling`; "
      "`deploy/reproduce "
      "sampling` runs it again. Shirley, Sung and Brown (1991, sections 2.2.1 and 4) report on n-rooks "
      "sampling "
      "without numbers. Here are some: RMS errors of linear values, of which 1 is white, on small scenes "
      "(`scenes/sampling`), the mean over {} seeds, against the mean of two pictures of {} Sobol samples "
      "with seeds "
      "of their own. `corners` cuts pixels into subpixels (`--subpixels`) and shares its rays between them, "
      "about as "
      "many as the others take; with one it averages over twice a pixel's width. `sobol` is the default.\n\n",
      seeds, page.reference_samples);
  for (const SampledScene& scene : page.scenes) text += fmt::format("![{0}]({0}.png) ", scene.name);
  text += "\n\n## Which claims hold\n\n" + claims_text(page) + wins_text(page) + ratios_text(page) +
          slopes_text(page) + factors_text(page);
  for (const SampledScene& scene : page.scenes) {
    text +=
        fmt::format("## {}\n\n{}. The reference's own error is about {:.2g}.\n\n![errors](errors_{}.svg)\n\n",
                    scene.name, scene.what, scene.reference_error, scene.name);
    text += header(page, "samples");
    for (size_t n = 0; n < page.samples.size(); ++n) {
      text += fmt::format("| {} |", page.samples[n]);
      for (const auto& errors : scene.errors)
        text += fmt::format(" {:.2e} ± {:.0f} % |", mean(errors[n]),
                            100 * spread(errors[n]) / std::max(1e-300, mean(errors[n])));
      text += "\n";
    }
    text += "\n";
  }
  return text +
         "± is the standard deviation over the seeds, of one picture. Regular samples and corners of edges "
         "and textures do not depend on the seed. `sampling.csv` has all numbers.\n";
}

const char* const kPlots = R"(# gnuplot sampling.gp
set terminal svg size 560,400 font "sans,12" background "white"
set key left bottom
set grid
set logscale x 2
set logscale y 10
set format y "10^{%T}"
set xlabel "samples per pixel"
set ylabel "RMS error"
)";

void write_plots(const SamplingPage& page, const fs::path& folder) {
  std::string script = kPlots;
  for (const SampledScene& scene : page.scenes) {
    std::string data = "samples";
    for (const std::string& pattern : page.patterns) data += " " + pattern;
    data += "\n";
    for (size_t n = 0; n < page.samples.size(); ++n) {
      data += fmt::format("{}", page.samples[n]);
      for (const auto& errors : scene.errors) data += fmt::format(" {:.4g}", mean(errors[n]));
      data += "\n";
    }
    write_text_file((folder / fmt::format("{}.dat", scene.name)).string(), data);
    script += fmt::format(
        "set output \"errors_{0}.svg\"\nset title \"{0}\" noenhanced\nplot for [i=2:{1}] \"{0}.dat\" using "
        "1:i with "
        "linespoints lc (i-1) title columnheader(i)\n",
        scene.name, page.patterns.size() + 1);
  }
  draw_plots(folder, "sampling.gp", script);
}

Table long_table(const SamplingPage& page) {
  Table table{"sampling", {"scene", "pattern", "samples", "rms", "deviation", "reference_error"}, {}};
  for (const SampledScene& scene : page.scenes)
    for (size_t p = 0; p < page.patterns.size(); ++p)
      for (size_t n = 0; n < page.samples.size(); ++n)
        table.rows.push_back({scene.name, page.patterns[p], double(page.samples[n]), mean(scene.errors[p][n]),
                              spread(scene.errors[p][n]), scene.reference_error});
  return table;
}

}  // namespace

void write_sampling_page(const SamplingPage& page, const fs::path& folder) {
  write_text_file((folder / "sampling.csv").string(), format_tables({long_table(page)}, TableFormat::csv));
  write_plots(page, folder);
  write_text_file((folder / "README.md").string(), page_text(page));
}

}  // namespace rayfarm
