#include "host/experiments/hierarchies/hierarchies_experiment.h"

#include <fmt/core.h>

#include <array>
#include <filesystem>

#include "host/experiments/hierarchies/hierarchies_page.h"
#include "host/experiments/page.h"
#include "host/experiments/plots.h"
#include "host/files/text_file.h"
#include "host/process/exit_code.h"

namespace rayfarm {
namespace {

constexpr int kSide_px = 256;  // the thesis's

struct Setting {
  const char* hierarchy;
  std::string setting;
  BuildOptions build;
};

/// Of an image, from 0: cuts as in Table 4.5, and as many cells as it had.
std::vector<Setting> make_settings(size_t image) {
  constexpr std::array<std::array<uint32_t, 3>, 3> kCells{{{23, 25, 27}, {7, 8, 9}, {15, 16, 17}}};
  std::vector<Setting> settings;
  for (const uint32_t cells : kCells[image])
    settings.push_back(
        {"regular", fmt::format("{}³ cells", cells), {.hierarchy = Hierarchy::regular, .cells = cells}});
  for (const uint32_t cut : {25u, 15u, 10u})
    settings.push_back(
        {"adaptive", fmt::format("{}", cut), {.hierarchy = Hierarchy::adaptive, .max_primitives = cut}});
  for (const uint32_t cut : {25u, 15u, 10u})
    settings.push_back(
        {"thesis", fmt::format("{}", cut), {.hierarchy = Hierarchy::thesis, .max_primitives = cut}});
  for (const uint32_t cut : {25u, 15u, 8u})
    settings.push_back({"sah", fmt::format("{}", cut), {.max_primitives = cut}});
  settings.push_back({"brute", "", {.hierarchy = Hierarchy::brute}});
  return settings;
}

const char* const kPlots = R"(# gnuplot hierarchies.gp
set terminal svg size 760,420 font "sans,12" background "white"
set key right top
set grid y
set style data histograms
set style fill solid 0.8
set logscale y
set ylabel "per ray"
set xtics rotate by -30
set output "tests.svg"
set title "Primitives that a ray tests"
plot for [i=1:3] "hierarchies.dat" using (column(i+1)):xtic(1) title sprintf("Image %d", i)
set output "times.svg"
set title "Nanoseconds that a ray takes"
plot for [i=1:3] "hierarchies.dat" using (column(i+4)):xtic(1) title sprintf("Image %d", i)
)";

/// The first setting of each hierarchy, image by image.
void write_plots(const std::filesystem::path& folder, const std::vector<HierarchyRow>& rows) {
  std::string data = "# hierarchy, primitives a ray of Images 1 to 3, nanoseconds\n";
  for (const char* hierarchy : {"brute", "regular", "adaptive", "thesis", "sah"}) {
    std::string tests, times;
    for (int image = 1; image <= 3; ++image)
      for (const HierarchyRow& row : rows)
        if (row.image == image && row.hierarchy == hierarchy) {
          tests += fmt::format(" {:.4g}", primitives_per_ray(row.run));
          times += fmt::format(" {:.4g}", row.run.ns_per_ray);
          break;
        }
    data += hierarchy + tests + times + "\n";
  }
  write_text_file((folder / "hierarchies.dat").string(), data);
  draw_plots(folder, "hierarchies.gp", kPlots);
}

}  // namespace

int run_hierarchies_experiment(const ExperimentOptions& options) {
  const std::filesystem::path folder = make_page_folder(options.output),
                              scenes = std::filesystem::path(options.scenes) / "hierarchies";
  const int side_px = options.width_px > 0 ? options.width_px : kSide_px;
  const std::array<const char*, 3> images{"beach_house.yaml", "primitives.yaml", "plant.yaml"};
  std::vector<HierarchyRow> rows;
  for (size_t image = 0; image < images.size(); ++image) {
    const SceneDescription scene = load_scene((scenes / images[image]).string());
    const PictureRays rays = record_rays(scene, side_px);
    const double list = bytes_of_list(scene);
    for (const Setting& s : make_settings(image)) {
      fmt::print(stderr, "hierarchies: image {}, {} {}\n", image + 1, s.hierarchy, s.setting);
      rows.push_back(
          {static_cast<int>(image + 1), s.hierarchy, s.setting, run_hierarchy(scene, s.build, rays, list)});
    }
  }
  write_text_file((folder / "hierarchies.csv").string(),
                  format_tables({hierarchies_table(rows)}, TableFormat::csv));
  write_text_file((folder / "hierarchies.json").string(),
                  format_tables({hierarchies_table(rows)}, TableFormat::json));
  write_plots(folder, rows);
  write_text_file((folder / "README.md").string(), hierarchies_page(rows, side_px));
  fmt::print("{}\n", (folder / "README.md").string());
  return kComplete;
}

}  // namespace rayfarm
