#include "host/experiments/hierarchies/hierarchy_plots.h"

#include <fmt/core.h>

#include "host/experiments/plots.h"
#include "host/files/text_file.h"

namespace rayfarm {
namespace {

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

set terminal svg size 960,620 font "sans,12" background "white"
set style data linespoints
set xtics norotate autofreq
set logscale x 2
set xrange [0.9:70]
unset ylabel
set output "cuts.svg"
set multiplot layout 2,3
set key left top
set xlabel "most primitives in a volume"
do for [i=1:3] {
  set title sprintf("Image %d: primitives a ray tests", i)
  plot for [h in "adaptive thesis sah"] sprintf("< grep '^%d %s ' cuts.dat", i, h) using 3:4 title h pointtype 7 pointsize 0.5
}
do for [i=1:3] {
  set title sprintf("Image %d: nanoseconds a ray", i)
  plot for [h in "adaptive thesis sah"] sprintf("< grep '^%d %s ' cuts.dat", i, h) using 3:5 title h pointtype 7 pointsize 0.5
}
unset multiplot

set terminal svg size 1060,400 font "sans,12" background "white"
set logscale x 10
set xrange [500:2e6]
set format x "10^{%L}"
set output "growth.svg"
set multiplot layout 1,2
set xlabel "triangles of the ground"
set title "Primitives a ray tests"
unset key
plot for [h in "brute object regular adaptive adaptive-pointers thesis sah"] sprintf("< grep '^%s ' growth.dat", h) using 2:3 title h pointtype 7 pointsize 0.5
set title "Nanoseconds a ray"
set key outside right top
plot for [h in "brute object regular adaptive adaptive-pointers thesis sah"] sprintf("< grep '^%s ' growth.dat", h) using 2:4 title h pointtype 7 pointsize 0.5
unset multiplot
)";

/// The first setting of each hierarchy, image by image.
std::string bars(const HierarchyStudy& study) {
  std::string data = "# hierarchy, primitives a ray of Images 1 to 3, nanoseconds\n";
  for (const char* hierarchy : {"brute", "object", "regular", "adaptive", "thesis", "sah"}) {
    std::string tests, times;
    for (int image = 1; image <= static_cast<int>(study.images.size()); ++image) {
      const HierarchyRun& run = study.run(image, hierarchy, 0);
      tests += fmt::format(" {:.4g}", run.primitives_per_ray());
      times += fmt::format(" {:.4g}", run.ns_per_ray);
    }
    data += hierarchy + tests + times + "\n";
  }
  return data;
}

}  // namespace

void write_plots(const std::filesystem::path& folder, const HierarchyStudy& study) {
  write_text_file((folder / "hierarchies.dat").string(), bars(study));
  std::string cuts = "# image, hierarchy, cut, primitives a ray, nanoseconds\n";
  for (size_t i = 0; i < study.images.size(); ++i)
    for (const GrowthPoint& p : study.images[i].cuts)
      cuts += fmt::format("{} {} {} {:.4g} {:.4g}\n", i + 1, p.hierarchy, p.number, p.tests_per_ray,
                          p.ns_per_ray);
  write_text_file((folder / "cuts.dat").string(), cuts);
  std::string growth = "# hierarchy, triangles, primitives a ray, nanoseconds\n";
  for (const GrowthPoint& p : study.growth)
    growth += fmt::format("{} {} {:.4g} {:.4g}\n", p.hierarchy, p.number, p.tests_per_ray, p.ns_per_ray);
  write_text_file((folder / "growth.dat").string(), growth);
  draw_plots(folder, "hierarchies.gp", kPlots);
}

}  // namespace rayfarm
