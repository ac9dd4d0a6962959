// Table 4.6 and Equations 4.1 to 4.3.
#include <fmt/core.h>

#include <algorithm>
#include <map>

#include "host/experiments/hierarchies/relations.h"
#include "host/experiments/hierarchies/unit_times.h"

namespace rayfarm {
namespace {

constexpr const char* kVolume = "thesis";

double milliseconds(double seconds) {
  return 1e3 * seconds;
}

/// The thesis's, where it has such a row.
std::string thesis_build(const HierarchyRow& row) {
  for (size_t k = 0; k < kSchemeNames.size(); ++k)
    if (row.hierarchy == kSchemeNames[k] &&
        std::find(kThesisCuts.begin(), kThesisCuts.end(), static_cast<int>(row.cut)) != kThesisCuts.end()) {
      const TimeRow& time = time_row(static_cast<Scheme>(k), row.image, static_cast<int>(row.cut));
      return fmt::format("{:.3g} s{}", time.build_s, time.is_estimate ? " (estimated)" : "");
    }
  return "";
}

std::string build_table(const HierarchyStudy& study) {
  std::string text =
      "| image | hierarchy | setting | nodes, cells or leaves | links to primitives | construction | the "
      "thesis "
      "|\n|---|---|---|---:|---:|---:|---:|\n";
  for (const HierarchyRow& row : study.rows)
    if (row.image > 0 && row.hierarchy != "brute")
      text += fmt::format("| {} | `{}` | {} | {} | {} | {:.2f} ms | {} |\n", row.image, row.hierarchy,
                          row.setting, row.run.cells + row.run.interior + row.run.leaves + row.run.objects,
                          row.run.pointers, milliseconds(row.run.build_cpu_s), thesis_build(row));
  return text + "\n";
}

std::string update_table(const HierarchyStudy& study) {
  std::string text =
      "| image | object nodes N_O | links N_C | T_M | T_L | N_C · T_L + N_O · T_M | the thesis |\n"
      "|---|---:|---:|---:|---:|---:|---:|\n";
  for (size_t i = 0; i < study.images.size(); ++i) {
    const UpdateTime& u = study.images[i].update;
    const double nodes = std::max(1.0, static_cast<double>(u.nodes)),
                 links = std::max(1.0, static_cast<double>(u.links));
    text +=
        fmt::format("| {} | {} | {} | {:.3f} µs | {:.3f} µs | {:.2f} µs | {} ms |\n", i + 1, u.nodes, u.links,
                    1e6 * u.matrices_s / nodes, 1e6 * std::max(0.0, u.whole_s - u.matrices_s) / links,
                    1e6 * u.whole_s, object_rows()[i].update_ms);
  }
  return text + "\n";
}

/// Equation 4.3 over a hierarchy's rows: nodes and links are what it counts.
std::string volume_equation(const HierarchyStudy& study) {
  std::map<std::string, std::vector<RayCosts>> by_hierarchy;
  for (const HierarchyRow& row : study.rows)
    if (row.image > 0 && row.hierarchy != "brute" && row.hierarchy != "object" && row.run.build_cpu_s > 0)
      by_hierarchy[row.hierarchy].push_back(
          {static_cast<double>(row.run.cells + row.run.interior + row.run.leaves),
           static_cast<double>(row.run.pointers), 1e9 * row.run.build_cpu_s});
  std::string text =
      "| hierarchy | rows | T_L, a node | T_C, a link | T_AUX | largest error "
      "|\n|---|---:|---:|---:|---:|---:|\n";
  for (const auto& [hierarchy, builds] : by_hierarchy) {
    const UnitTimes times = fit_unit_times(builds);
    text += fmt::format("| `{}` | {} | {:.0f} ns | {:.0f} ns | {:.1f} µs | {:.0f} % |\n", hierarchy,
                        builds.size(), times.step_ns, times.test_ns, 1e-3 * times.overhead_ns,
                        100 * largest_error(builds, times));
  }
  return text + "\n";
}

/// Equation 4.1 for frames in which objects move.
std::string sequence_table(const HierarchyStudy& study) {
  constexpr double kFrames = 100;
  std::string text = "| image |";
  const std::array<std::pair<const char*, uint32_t>, 5> choices{
      {{"regular", 25}, {"adaptive", 25}, {kVolume, 25}, {"object", 0}, {"sah", 8}}};
  for (const auto& [hierarchy, cut] : choices)
    text += fmt::format(" `{}`{} |", hierarchy, cut ? fmt::format(" {}", cut) : "");
  text += " kept over rebuilt, `thesis` |\n|---|---:|---:|---:|---:|---:|---:|\n";
  for (size_t i = 0; i < study.images.size(); ++i) {
    const ImageStudy& image = study.images[i];
    text += fmt::format("| {} |", i + 1);
    double kept = 0, rebuilt = 0;
    for (const auto& [hierarchy, cut] : choices) {
      const HierarchyRun& run = study.run(static_cast<int>(i + 1), hierarchy, cut);
      const double frames_s = kFrames * 1e-9 * run.ns_per_ray * static_cast<double>(image.rays);
      const bool is_rebuilt = hierarchy == std::string("regular") || hierarchy == std::string("adaptive");
      const double hierarchy_s =
          is_rebuilt ? kFrames * run.build_cpu_s : run.build_cpu_s + kFrames * image.update.whole_s;
      if (hierarchy == std::string(kVolume)) {
        kept = frames_s + hierarchy_s;
        rebuilt = frames_s + kFrames * run.build_cpu_s;
      }
      text += fmt::format(" {:.1f} + {:.2f} s |", frames_s, hierarchy_s);
    }
    text += fmt::format(" {:.2f} |\n", kept / rebuilt);
  }
  return text + "\n";
}

}  // namespace

std::string construction_text(const HierarchyStudy& study) {
  return "## Construction and update (Table 4.6)\n\nCPU time of all threads, the median of five builds, "
         "beyond what "
         "compiling the scene to a list takes; of `object` the bounding volumes, where the thesis's time is "
         "the "
         "user's who arranged them.\n\n" +
         build_table(study) +
         "Equation 4.3, T_V = N_V · T_L + Σ T_C + T_AUX, with the clipping of a node by the links that come "
         "of it; "
         "unit times by least squares of relative errors over the rows above:\n\n" +
         volume_equation(study) +
         "Links are clippings that left something. Those that left nothing cost time too, most of them where "
         "few large "
         "primitives stand in many boxes: where the error is large they are not in proportion to links.\n\n"
         "What stands in object spaces is kept while objects move (`sah`, `thesis`, `object`; thesis "
         "4.3.3.1). Each "
         "object of the images got a moving place, and a frame's state was made: Equation 4.2 without T_S. "
         "T_M "
         "composes and inverts a node's transform, T_L sets the boxes over it. Medians of 200 frames; the "
         "thesis's T_M "
         "is 157 µs and its T_L 3.6 µs.\n\n" +
         update_table(study) +
         fmt::format(
             "Equation 4.1, T_T = Σ T_F + Σ T_H, for 100 frames of {0} × {0} pixels in which objects move: "
             "tracing "
             "all rays one by one on one core, and the hierarchy, which `regular` and `adaptive` build again "
             "for each frame.\n\n",
             study.side_px) +
         sequence_table(study);
}

std::vector<Relation> construction_relations(const HierarchyStudy& study) {
  std::vector<Relation> relations;
  for (int image = 1; image <= 3; ++image) {
    const auto build_s = [&](Scheme scheme) { return study.run(image, scheme, 25).build_cpu_s; };
    const HierarchyRun &volume = study.run(image, Scheme::object_volume, 25),
                       &adaptive = study.run(image, Scheme::adaptive, 25);
    const double thesis =
        time_row(Scheme::object_volume, image, 25).build_s / time_row(Scheme::adaptive, image, 25).build_s;
    const double here = build_s(Scheme::object_volume) / std::max(1e-9, build_s(Scheme::adaptive));
    relations.push_back(
        {fmt::format("Image {}: construction of object/volume over adaptive at 25 (rank)", image),
         fmt::format("{:.2f}: not slower", thesis), fmt::format("{:.2f}", here), here <= 1.05,
         fmt::format("object/volume makes {} volumes with {} links of the primitives' triangles in {:.2f} "
                     "ms, adaptive "
                     "{} nodes with {} links of whole primitives in {:.2f} ms",
                     volume.interior + volume.leaves, volume.pointers, milliseconds(volume.build_cpu_s),
                     adaptive.cells, adaptive.pointers, milliseconds(adaptive.build_cpu_s))});
    const UpdateTime& update = study.images[static_cast<size_t>(image - 1)].update;
    constexpr double kThesis = 91;  // .29 s over 3.2 ms
    const double least = build_s(Scheme::object_volume) / std::max(1e-12, update.whole_s);
    relations.push_back({fmt::format("Image {}: rebuilding object/volume over updating it", image),
                         "91 or more", fmt::format("{:.0f}", least), least >= kThesis,
                         fmt::format("building {} volumes takes {:.2f} ms and moving {} objects {:.2f} µs",
                                     volume.interior + volume.leaves, milliseconds(volume.build_cpu_s),
                                     update.links, 1e6 * update.whole_s)});
  }
  return relations;
}

}  // namespace rayfarm
