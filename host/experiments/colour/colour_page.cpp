#include "host/experiments/colour/colour_page.h"

#include <fmt/core.h>

#include <algorithm>

#include "host/experiments/plots.h"
#include "host/files/text_file.h"

namespace rayfarm {
namespace {

std::string make_csv(std::span<const ColourScene> scenes) {
  std::string csv =
      "scene,model,nodes,passes,rays,trace_s,time_ratio,mean_difference,difference_of_95_percent,largest_"
      "difference,"
      "share_over_1\n";
  for (const ColourScene& scene : scenes)
    for (const ColourOutcome& m : scene.models)
      csv +=
          fmt::format("{},{},{},{},{:.0f},{:.4f},{:.3f},{:.4f},{:.4f},{:.4f},{:.5f}\n", scene.picture->name,
                      m.choice->name, m.nodes, m.passes, m.rays, m.trace_s,
                      m.trace_s / scene.models.front().trace_s, m.from_reference.mean,
                      m.from_reference.most_of_95, m.from_reference.largest, m.from_reference.share_over_1);
  return csv;
}

constexpr const char* kPlot = R"(# gnuplot colour.gp
set terminal svg size 760,420 font "sans,12" background "white"
set output "colour.svg"
set grid
set logscale xy 10
set key left bottom
set xlabel "time over RGB's"
set ylabel "mean CIEDE2000 from 200 wavelengths"
set title "RGB, 4, 20 and the scene's own wavelengths"
plot for [i=0:2] "colour.dat" index i using 1:2 with linespoints lc i+1 pt 7 title columnheader(1), \
     for [i=0:2] "colour.dat" index i using 1:2:3 with labels offset 0,0.8 font "sans,10" notitle
)";

std::string make_data(std::span<const ColourScene> scenes) {
  std::string data;
  for (const ColourScene& scene : scenes) {
    if (!data.empty()) data += "\n\n";
    data += fmt::format("\"{}\"\n", scene.picture->name);
    for (const ColourOutcome& m : scene.models)
      if (!m.choice->is_reference)
        data += fmt::format("{:.3f} {:.5f} \"{}\"\n", m.trace_s / scene.models.front().trace_s,
                            std::max(1e-3, m.from_reference.mean), m.choice->name);
  }
  return data;
}

/// Of how many scenes it holds.
template <typename Condition>
std::string count_of(std::span<const ColourScene> scenes, Condition holds) {
  const auto n = std::count_if(scenes.begin(), scenes.end(), holds);
  return fmt::format("{} of {}", n, scenes.size());
}

std::string make_page(std::span<const ColourScene> scenes) {
  std::string page =
      "# Colour: RGB, and spectra at 4, 20 and any wavelengths\n\nWritten by `rayfarm experiment colour` "
      "(Shirley, Sung and Brown 1991, section 2.1). A spectrum is a straight line between nodes. `spectral` "
      "is their general model: its nodes are those of all colours of the scene, so that every spectrum is "
      "what it was given as and every product is right at each node of both. The reference is "
      "`spectral:200`. Differences are CIEDE2000 over all pixels as a screen shows them; 1 is just seen side "
      "by side. Dispersion is no colour: on `prism` the general model has the nodes of its RGB colours "
      "alone. Times are of one processor of this machine, the fastest of three runs (the reference: one), "
      "and mean something only as ratios.\n\n| scene | model | nodes | passes | trace | time over RGB | mean "
      "| 95 % are below | largest | pixels above 1 |\n|---|---|---:|---:|---:|---:|---:|---:|---:|---:|\n";
  for (const ColourScene& scene : scenes)
    for (const ColourOutcome& m : scene.models)
      page += fmt::format("| {} | {} | {} | {} | {:.3f} s | {:.2f} | {:.3f} | {:.2f} | {:.2f} | {:.1f} % |\n",
                          scene.picture->name, m.choice->name, m.nodes, m.passes, m.trace_s,
                          m.trace_s / scene.models.front().trace_s, m.from_reference.mean,
                          m.from_reference.most_of_95, m.from_reference.largest,
                          100 * m.from_reference.share_over_1);
  page += "\nThe scenes: ";
  for (const ColourScene& scene : scenes)
    page += fmt::format("{}`{}.yaml`, {}", &scene == &scenes.front() ? "" : "; ", scene.picture->name,
                        scene.picture->what);
  page += ".\n\n![time and difference](colour.svg)\n\n## \"typically, the run time more than doubled\"\n\n";
  page += fmt::format(
      "Of the general model, against RGB. Here rays carry three nodes, and the picture is traced once for "
      "each three (with dispersion for each one), so that time grows with the nodes: it is more than double "
      "in {} scenes. The authors' rays carried whole spectra, as lists that each operation makes anew. What "
      "that takes is measured apart: the light times what reflects it, added to another such product, once "
      "for each ray of the picture in RGB. By that the run time would be more than double in {} scenes.\n\n| "
      "scene | nodes of such a sum | as a list | as RGB | rays | run time over RGB, with lists "
      "|\n|---|---:|---:|---:|---:|---:|\n",
      count_of(scenes, [](const ColourScene& s) { return s.models[3].trace_s > 2 * s.models[0].trace_s; }),
      count_of(scenes, [](const ColourScene& s) {
        return s.models[0].rays * (s.cost.list_s - s.cost.rgb_s) > s.models[0].trace_s;
      }));
  for (const ColourScene& scene : scenes) {
    const ColourOutcome& rgb = scene.models.front();
    page += fmt::format("| {} | {:.1f} | {:.0f} ns | {:.1f} ns | {:.2f} M | {:.2f} |\n", scene.picture->name,
                        scene.cost.nodes, 1e9 * scene.cost.list_s, 1e9 * scene.cost.rgb_s, 1e-6 * rgb.rays,
                        1 + rgb.rays * (scene.cost.list_s - scene.cost.rgb_s) / rgb.trace_s);
  }
  page += fmt::format(
      "\n## \"no qualitative loss in image quality observed going from the twenty to four samples\"\n\nThe "
      "authors suspect that this says \"more about the arbitrary nature of most of the input spectral "
      "curves\". With these spectra, picture against picture, more than one pixel in twenty differs visibly "
      "(by more than 1) in {} scenes; and in {} the four are farther from the reference than the "
      "twenty.\n\n| scene | mean from 20 to 4 | 95 % are below | largest | pixels above 1 "
      "|\n|---|---:|---:|---:|---:|\n",
      count_of(scenes, [](const ColourScene& s) { return s.from_20_to_4.share_over_1 > 0.05; }),
      count_of(scenes, [](const ColourScene& s) {
        return s.models[1].from_reference.mean > s.models[2].from_reference.mean;
      }));
  for (const ColourScene& scene : scenes)
    page += fmt::format("| {} | {:.3f} | {:.2f} | {:.2f} | {:.1f} % |\n", scene.picture->name,
                        scene.from_20_to_4.mean, scene.from_20_to_4.most_of_95, scene.from_20_to_4.largest,
                        100 * scene.from_20_to_4.share_over_1);
  page += "\n## The pictures\n\n| ";
  for (const ColourOutcome& model : scenes.front().models) page += fmt::format("{} | ", model.choice->name);
  page += "\n|";
  for (size_t i = 0; i < scenes.front().models.size(); ++i) page += "---|";
  for (const ColourScene& scene : scenes) {
    page += "\n|";
    for (const ColourOutcome& model : scene.models)
      page += fmt::format(" ![{0} {1}]({0}_{2}.png) |", scene.picture->name, model.choice->name,
                          model.choice->is_reference ? "reference" : model.choice->name);
  }
  return page + "\n";
}

}  // namespace

void write_colour_page(const std::filesystem::path& folder, std::span<const ColourScene> scenes) {
  write_text_file((folder / "colour.csv").string(), make_csv(scenes));
  write_text_file((folder / "colour.dat").string(), make_data(scenes));
  draw_plots(folder, "colour.gp", kPlot);
  write_text_file((folder / "README.md").string(), make_page(scenes));
}

}  // namespace rayfarm
