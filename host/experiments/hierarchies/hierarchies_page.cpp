#include "host/experiments/hierarchies/hierarchies_page.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>

#include "host/experiments/hierarchies/unit_times.h"

namespace rayfarm {
namespace {

double ratio(double a, double b) {
  return b > 0 ? a / b : 0;
}

double per_ray(uint64_t count, const KindCosts& kind) {
  return ratio(static_cast<double>(count), static_cast<double>(kind.rays));
}

uint64_t volumes(const WalkCounts& c) {
  return c.cells + c.nodes + (c.cells > 0 ? 0 : c.leaves);
}

const HierarchyRow* find(const std::vector<HierarchyRow>& rows, int image, const std::string& hierarchy,
                         const std::string& setting) {
  const auto row = std::find_if(rows.begin(), rows.end(), [&](const HierarchyRow& r) {
    return r.image == image && r.hierarchy == hierarchy && (setting.empty() || r.setting == setting);
  });
  return row == rows.end() ? nullptr : &*row;
}

std::string image_table(const std::vector<HierarchyRow>& rows, int image) {
  std::string text =
      "| hierarchy | setting | volumes or cells | empty | pointers | thesis's bytes | bytes here | N_V | N_P "
      "| N_P eye | "
      "secondary | shadow | ns a ray |\n|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n";
  for (const HierarchyRow& row : rows) {
    if (row.image != image) continue;
    const HierarchyRun& r = row.run;
    text += fmt::format(
        "| `{}` | {} | {} | {} | {} | {:.0f} | {:.0f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.0f} "
        "|\n",
        row.hierarchy, row.setting, r.cells > 0 ? r.cells : r.interior + r.leaves,
        row.hierarchy == "regular" ? fmt::format("{:.0f} %", 100.0 * ratio(double(r.empty), double(r.cells)))
                                   : std::string(),
        r.pointers, r.thesis_bytes, r.bytes, volumes_per_ray(r), primitives_per_ray(r),
        per_ray(r.eye.counts.primitives(), r.eye), per_ray(r.secondary.counts.primitives(), r.secondary),
        per_ray(r.shadow.counts.primitives(), r.shadow), r.ns_per_ray);
  }
  return text + "\n";
}

std::string equation_table(const std::vector<HierarchyRow>& rows) {
  std::map<std::string, std::vector<RayCosts>> by_hierarchy;
  for (const HierarchyRow& row : rows)
    by_hierarchy[row.hierarchy].push_back(
        {volumes_per_ray(row.run), primitives_per_ray(row.run), row.run.ns_per_ray});
  std::string text =
      "| hierarchy | rows | T_N | T_P | T_O | largest error | within 25 % "
      "|\n|---|---:|---:|---:|---:|---:|---|\n";
  for (const auto& [hierarchy, rays] : by_hierarchy) {
    const UnitTimes times = fit_unit_times(rays);
    const double error = largest_error(rays, times);
    text += fmt::format("| `{}` | {} | {:.1f} ns | {:.1f} ns | {:.1f} ns | {:.0f} % | {} |\n", hierarchy,
                        rays.size(), times.step_ns, times.test_ns, times.overhead_ns, 100 * error,
                        error <= 0.25 ? "yes" : "no");
  }
  return text + "\n";
}

/// A statement of the seed about numbers, and whether ours say the same.
struct Relation {
  std::string what, seed, ours;
  bool holds;
};

std::vector<Relation> make_relations(const std::vector<HierarchyRow>& rows) {
  std::vector<Relation> relations;
  const auto run = [&](int image, const char* hierarchy, const char* setting) -> const HierarchyRun& {
    return find(rows, image, hierarchy, setting)->run;
  };
  const std::array<const char*, 3> coarse{"23³ cells", "7³ cells", "15³ cells"};
  const std::array<double, 3> seed_empty{89, 43, 53};
  const std::array<std::array<double, 3>, 3> seed_tests{
      {{54, 296, 314}, {4.92, 39.4, 42.1}, {19.8, 20.1, 32.3}}};
  for (int image = 1; image <= 3; ++image) {
    const auto i = static_cast<size_t>(image - 1);
    const HierarchyRun &grid = run(image, "regular", coarse[i]), &volume = run(image, "thesis", "25");
    const HierarchyRun &fine = run(image, "thesis", "10"), &list = run(image, "brute", "");
    const double empty = 100 * ratio(double(grid.empty), double(grid.cells));
    relations.push_back({fmt::format("Image {}: empty cells of {}", image, coarse[i]),
                         fmt::format("{:.0f} % (± 10)", seed_empty[i]), fmt::format("{:.0f} %", empty),
                         std::abs(empty - seed_empty[i]) <= 10});
    const double a = primitives_per_ray(grid), b = primitives_per_ray(volume),
                 o = primitives_per_ray(run(image, "adaptive", "25"));
    relations.push_back(
        {fmt::format("Image {}: N_P at 25 rises: object/volume, adaptive, regular", image),
         fmt::format("{:.1f}, {:.1f}, {:.1f}", seed_tests[i][0], seed_tests[i][1], seed_tests[i][2]),
         fmt::format("{:.1f}, {:.1f}, {:.1f}", b, o, a), b <= o && o <= a});
    relations.push_back({fmt::format("Image {}: N_P at 25, object/volume against all of what is met", image),
                         "less", fmt::format("{:.1f}, {:.0f}", b, primitives_per_ray(list)),
                         primitives_per_ray(list) > b});
    if (image == 2) continue;  // a single volume at every cut in the seed
    relations.push_back({fmt::format("Image {}: a smaller cut: N_V up, N_P down (25 to 10)", image),
                         "up, down",
                         fmt::format("{:.1f} to {:.1f}, {:.1f} to {:.1f}", volumes_per_ray(volume),
                                     volumes_per_ray(fine), b, primitives_per_ray(fine)),
                         volumes_per_ray(fine) > volumes_per_ray(volume) && primitives_per_ray(fine) < b});
    const auto add_bytes = [&](const char* of, double seed, const HierarchyRun& other) {
      constexpr double kFactor = 1.5;  // scenes are rebuilt
      const double bytes = ratio(volume.thesis_bytes, other.thesis_bytes);
      relations.push_back({fmt::format("Image {}: bytes of object/volume over {} at 25", image, of),
                           fmt::format("{:.2f} (times or over 1.5)", seed), fmt::format("{:.2f}", bytes),
                           bytes < kFactor * seed && bytes > seed / kFactor});
    };
    add_bytes("regular", image == 1 ? 0.20 : 0.77, grid);
    add_bytes("adaptive", image == 1 ? 0.25 : 1.14, run(image, "adaptive", "25"));
  }
  return relations;
}

std::string relations_table(const std::vector<HierarchyRow>& rows) {
  std::string text = "| relation | the thesis | here | |\n|---|---|---|---|\n";
  for (const Relation& r : make_relations(rows))
    text += fmt::format("| {} | {} | {} | {} |\n", r.what, r.seed, r.ours,
                        r.holds ? "holds" : "**does not hold**");
  return text + "\n";
}

std::string choice_text(const std::vector<HierarchyRow>& rows) {
  std::string text;
  for (int image = 1; image <= 3; ++image) {
    const HierarchyRow* best = nullptr;
    for (const HierarchyRow& row : rows)
      if (row.image == image && (!best || row.run.ns_per_ray < best->run.ns_per_ray)) best = &row;
    const HierarchyRow* list = find(rows, image, "brute", "");
    text += fmt::format("- Image {}: `{}` {}, {:.0f} ns a ray, {:.1f} times as fast as testing all.\n", image,
                        best->hierarchy, best->setting, best->run.ns_per_ray,
                        ratio(list->run.ns_per_ray, best->run.ns_per_ray));
  }
  return text;
}

}  // namespace

double volumes_per_ray(const HierarchyRun& r) {
  return ratio(
      static_cast<double>(volumes(r.eye.counts) + volumes(r.secondary.counts) + volumes(r.shadow.counts)),
      static_cast<double>(r.eye.rays + r.secondary.rays + r.shadow.rays));
}

double primitives_per_ray(const HierarchyRun& r) {
  return ratio(static_cast<double>(r.eye.counts.primitives() + r.secondary.counts.primitives() +
                                   r.shadow.counts.primitives()),
               static_cast<double>(r.eye.rays + r.secondary.rays + r.shadow.rays));
}

Table hierarchies_table(const std::vector<HierarchyRow>& rows) {
  Table table{"hierarchies",
              {"image",
               "hierarchy",
               "setting",
               "primitives",
               "pointers",
               "interior",
               "leaves",
               "cells",
               "empty",
               "thesis_bytes",
               "bytes",
               "build_s",
               "eye_rays",
               "secondary_rays",
               "shadow_rays",
               "volumes_per_ray",
               "primitives_per_ray",
               "eye_primitives",
               "secondary_primitives",
               "shadow_primitives",
               "ns_per_ray"},
              {}};
  for (const HierarchyRow& row : rows) {
    const HierarchyRun& r = row.run;
    table.rows.push_back({double(row.image),
                          row.hierarchy,
                          row.setting,
                          double(r.primitives),
                          double(r.pointers),
                          double(r.interior),
                          double(r.leaves),
                          double(r.cells),
                          double(r.empty),
                          r.thesis_bytes,
                          r.bytes,
                          r.build_s,
                          double(r.eye.rays),
                          double(r.secondary.rays),
                          double(r.shadow.rays),
                          volumes_per_ray(r),
                          primitives_per_ray(r),
                          per_ray(r.eye.counts.primitives(), r.eye),
                          per_ray(r.secondary.counts.primitives(), r.secondary),
                          per_ray(r.shadow.counts.primitives(), r.shadow),
                          r.ns_per_ray});
  }
  return table;
}

std::string hierarchies_page(const std::vector<HierarchyRow>& rows, int side_px) {
  std::string text = fmt::format(
      "# Hierarchies\n\nWritten by `rayfarm experiment hierarchies`; `deploy/reproduce hierarchies` runs it "
      "again. The thesis's "
      "three images ([rebuilt](../../../scenes/hierarchies/README.md)), {0} × {0} pixels with a ray through "
      "each corner, in "
      "Whitted's model. The rays of a picture were written down once, eye, secondary and shadow rays apart, "
      "and every "
      "hierarchy was asked the same. N_V: nodes and leaves, or cells, that a ray visits (of `adaptive` the "
      "undivided ones; its volumes are nodes of the construction tree); N_P: primitives "
      "that it tests, a polygon "
      "being one (the thesis's Table 4.7). Bytes are those of Table 4.5's formulas, without the object "
      "nodes, and ours: nodes, "
      "cells, lists, and primitives in leaves beyond one of each. Times are the least of three runs through "
      "all rays, one by one "
      "on one core; ours are tested eight at a time in `sah`, `thesis` and `brute`, and one by one in "
      "cells.\n\n",
      side_px);
  for (int image = 1; image <= 3; ++image) {
    const HierarchyRun& r = find(rows, image, "brute", "")->run;
    text += fmt::format("## Image {}\n\n{} primitives; {} eye rays, {} secondary, {} shadow rays.\n\n", image,
                        r.primitives, r.eye.rays, r.secondary.rays, r.shadow.rays);
    text += image_table(rows, image);
  }
  text += "![tests per ray](tests.svg)\n\n![time per ray](times.svg)\n\n## What holds\n\n" +
          relations_table(rows) +
          "Of a quadric the piece in a cell is taken to be as large as its box: the sky of Image 2 is one, "
          "and stands in all cells. "
          "Pointers to primitives with a part in a cell are fewer in large equal cells than the thesis's; "
          "its scenes are not known.\n\n";
  text +=
      "## Equation 4.5\n\nA ray's time is N_V · T_N + N_P · T_P + T_O. The unit times that foretell the rows "
      "above best, by least "
      "squares of relative errors:\n\n" +
      equation_table(rows) +
      "Where primitives are tested eight at a time, T_P is an eighth of a block's, if blocks are full.\n\n## "
      "Which now\n\n" +
      choice_text(rows) + "\n`hierarchies.csv` has all numbers, with seconds of building.\n";
  return text;
}

}  // namespace rayfarm
