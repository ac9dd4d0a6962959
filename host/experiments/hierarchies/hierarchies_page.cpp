#include "host/experiments/hierarchies/hierarchies_page.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <stdexcept>

#include "host/experiments/hierarchies/relations.h"
#include "host/experiments/hierarchies/unit_times.h"

namespace rayfarm {
namespace {

constexpr std::array kImageNames{"beach_house", "primitives", "plant"};

double ratio(double a, double b) {
  return b > 0 ? a / b : 0;
}

double per_ray(uint64_t count, const KindCosts& kind) {
  return ratio(static_cast<double>(count), static_cast<double>(kind.rays));
}

std::string image_table(const std::vector<HierarchyRow>& rows, int image) {
  std::string text =
      "| hierarchy | setting | volumes, cells or objects | empty | pointers | thesis's bytes | bytes here | "
      "N_V | N_P "
      "| N_P eye | "
      "secondary | shadow | ns a ray |\n|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n";
  for (const HierarchyRow& row : rows) {
    if (row.image != image) continue;
    const HierarchyRun& r = row.run;
    text += fmt::format(
        "| `{}` | {} | {} | {} | {} | {:.0f} | {:.0f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.0f} "
        "|\n",
        row.hierarchy, row.setting, r.cells + r.interior + r.leaves + r.objects,
        row.hierarchy == "regular" ? fmt::format("{:.0f} %", 100.0 * ratio(double(r.empty), double(r.cells)))
                                   : std::string(),
        r.pointers, r.thesis_bytes, r.bytes, r.volumes_per_ray(), r.primitives_per_ray(),
        per_ray(r.eye.counts.primitives(), r.eye), per_ray(r.secondary.counts.primitives(), r.secondary),
        per_ray(r.shadow.counts.primitives(), r.shadow), r.ns_per_ray);
  }
  return text + "\n";
}

/// N_V of adaptive may be read as nodes of its tree.
std::string tree_nodes_text(const HierarchyStudy& study, int image) {
  std::string text = "Nodes of the construction tree that a ray of `adaptive` looks at to find its cells, at";
  for (const int cut : kThesisCuts) {
    const KindCosts costs = study.run(image, Scheme::adaptive, cut).all();
    text += fmt::format(" {}: {:.1f},", cut, per_ray(costs.counts.tree_nodes, costs));
  }
  text += " where the thesis's N_V is";
  for (const int cut : kThesisCuts)
    text += fmt::format(" {},", time_row(Scheme::adaptive, image, cut).volumes);
  text.back() = '.';
  return text + "\n\n";
}

std::string equation_table(const std::vector<HierarchyRow>& rows) {
  std::map<std::string, std::vector<RayCosts>> by_hierarchy;
  for (const HierarchyRow& row : rows)
    if (row.image > 0)
      by_hierarchy[row.hierarchy].push_back(
          {row.run.volumes_per_ray(), row.run.primitives_per_ray(), row.run.ns_per_ray});
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

}  // namespace

const HierarchyRun& HierarchyStudy::run(int image, const std::string& hierarchy, uint32_t cut) const {
  const auto row = std::find_if(rows.begin(), rows.end(), [&](const HierarchyRow& r) {
    return r.image == image && r.hierarchy == hierarchy && (cut == 0 || r.cut == cut);
  });
  if (row == rows.end()) throw std::logic_error("no such hierarchy was measured");
  return row->run;
}

Table hierarchies_table(const std::vector<HierarchyRow>& rows) {
  Table table{"hierarchies",
              {"scene",
               "hierarchy",
               "setting",
               "primitives",
               "pointers",
               "interior",
               "leaves",
               "cells",
               "empty",
               "objects",
               "thesis_bytes",
               "bytes",
               "build_cpu_s",
               "eye_rays",
               "secondary_rays",
               "shadow_rays",
               "volumes_per_ray",
               "primitives_per_ray",
               "eye_primitives",
               "secondary_primitives",
               "shadow_primitives",
               "groups_and_objects_entered",
               "bounding_volumes_tested",
               "type_1_rays",
               "type_2_rays",
               "type_3_rays",
               "hits",
               "answers",
               "ns_per_ray"},
              {}};
  for (const HierarchyRow& row : rows) {
    const HierarchyRun& r = row.run;
    const KindCosts all = r.all();
    table.rows.push_back({row.scene,
                          row.hierarchy,
                          row.setting,
                          double(r.primitives),
                          double(r.pointers),
                          double(r.interior),
                          double(r.leaves),
                          double(r.cells),
                          double(r.empty),
                          double(r.objects),
                          r.thesis_bytes,
                          r.bytes,
                          r.build_cpu_s,
                          double(r.eye.rays),
                          double(r.secondary.rays),
                          double(r.shadow.rays),
                          r.volumes_per_ray(),
                          r.primitives_per_ray(),
                          per_ray(r.eye.counts.primitives(), r.eye),
                          per_ray(r.secondary.counts.primitives(), r.secondary),
                          per_ray(r.shadow.counts.primitives(), r.shadow),
                          per_ray(all.counts.groups + all.counts.objects, all),
                          per_ray(all.counts.bounding_volumes(), all),
                          double(all.types[0]),
                          double(all.types[1]),
                          double(all.types[2]),
                          double(all.hits),
                          fmt::format("{:016x}", all.answers),
                          r.ns_per_ray});
  }
  return table;
}

std::string hierarchies_page(const HierarchyStudy& study) {
  std::string text = fmt::format(
      "# Hierarchies\n\nWritten by `rayfarm experiment hierarchies`; `deploy/reproduce hierarchies` runs it "
      "again. "
      "The thesis's three images ([rebuilt](../../../scenes/hierarchies/README.md)), {0} × {0} pixels with a "
      "ray "
      "through each corner, in Whitted's model. The rays of a picture were written down once, eye, secondary "
      "and "
      "shadow rays apart, and every hierarchy was asked the same. N_V: nodes and leaves, or cells, that a "
      "ray visits "
      "(of `adaptive` the undivided ones; its volumes are nodes of the construction tree), or of `object` "
      "N_O, objects "
      "and groups that are looked at, met or missed; N_P: primitives that it tests, a polygon being one (the "
      "thesis's "
      "Table 4.7). Bytes are those of Table 4.5's formulas, with the object nodes where the thesis has them, "
      "and ours: "
      "nodes, cells, lists, and primitives in leaves beyond one of each. Times are the least of five passes "
      "through "
      "all rays, one by one on one core; primitives are tested eight at a time in `sah`, `thesis`, `object` "
      "and "
      "`brute`, and one by one in cells.\n\n",
      study.side_px);
  for (size_t i = 0; i < study.images.size(); ++i) {
    const HierarchyRun& r = study.run(static_cast<int>(i + 1), "brute", 0);
    text += fmt::format("## Image {}\n\n{} primitives; {} eye rays, {} secondary, {} shadow rays.\n\n", i + 1,
                        r.primitives, r.eye.rays, r.secondary.rays, r.shadow.rays);
    text += image_table(study.rows, static_cast<int>(i + 1));
    text += tree_nodes_text(study, static_cast<int>(i + 1));
    text += fmt::format("![tests per pixel of Image {}](tests_{}.png)\n\n", i + 1, kImageNames[i]);
  }
  text +=
      "![tests per ray](tests.svg)\n\n![time per ray](times.svg)\n\nThe heat maps show how many primitives "
      "the rays of each pixel test, eye, secondary and shadow rays "
      "together, one ray through a pixel, `adaptive` and `thesis` at 15, `regular` with the first number of "
      "cells above; "
      "`rayfarm experiment hierarchies --picture tests` draws them larger, and of any scene with "
      "`--scene`.\n\n## What "
      "holds\n\nObject/volume is `thesis` to the letter (`--thesis-volumes spheres --thesis-clip always`), "
      "in the "
      "rows `thesis, spheres` over all primitives at once, and in the rows `object/volume`, by which the "
      "relations are judged, below each object, which stands in a sphere (`--hierarchy object`, and in it "
      "`structure: {thesis: {volumes: spheres, clip: always}}` on each object). Orders of numbers, and "
      "ratios "
      "within the factor 1.5, since the scenes are rebuilt. \"VAX ms\" puts the counts of this page into "
      "Equations "
      "4.4 and 4.5 with the thesis's unit times: T_P .303 ms; T_N .102, .216 and .245 ms of regular, "
      "adaptive and "
      "object/volume; T_O 0, .05 and .153 · N_O ms, T_B + T_L .153 ms.\n\n" +
      relations_text(make_relations(study)) +
      "## Equations 4.4 and 4.5\n\nA ray's time is N_V · T_N + N_P · T_P + T_O; of objects N_O (T_B + T_L) + "
      "N_P · "
      "T_P. The unit times that foretell the rows above best, by least squares of relative errors:\n\n" +
      equation_table(study.rows) +
      "Where primitives are tested eight at a time, T_P is an eighth of a block's, if blocks are full. Rows "
      "of `object` differ in the kinds of volumes too, which one T_B + T_L does not tell apart.\n\n" +
      construction_text(study) + profile_text(study) + today_text(study) +
      "`hierarchies.csv` has all numbers.\n";
  return text;
}

}  // namespace rayfarm
