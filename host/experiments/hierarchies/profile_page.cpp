// Tables 4.8 to 4.12 and Figure 4.6.
#include <fmt/core.h>

#include "host/experiments/hierarchies/relations.h"
#include "host/experiments/hierarchies/unit_times.h"

namespace rayfarm {
namespace {

double part(uint64_t some, uint64_t all) {
  return all > 0 ? static_cast<double>(some) / static_cast<double>(all) : 0;
}

/// Table 4.10's three.
struct Summary {
  double intersection_s, traversal_s, other_s;
  double total_s() const { return intersection_s + traversal_s + other_s; }
};

/// Searching is divided as Equation 4.5 divides it, with the unit times of all rows of object/volume.
Summary summarize(const HierarchyStudy& study, size_t image) {
  std::vector<RayCosts> rows;
  for (const HierarchyRow& row : study.rows)
    if (row.image > 0 && row.hierarchy == "thesis")
      rows.push_back({row.run.volumes_per_ray(), row.run.primitives_per_ray(), row.run.ns_per_ray});
  const UnitTimes times = fit_unit_times(rows);
  const HierarchyRun& run = study.run(static_cast<int>(image + 1), "thesis", 15);
  const RenderProfile& p = study.images[image].profile;
  const RayCosts ray{run.volumes_per_ray(), run.primitives_per_ray(), run.ns_per_ray};
  const double tests = ray.primitives * times.test_ns / std::max(1e-9, times.ns(ray));
  return {p.search_s * tests, p.search_s * (1 - tests), std::max(0.0, p.frame_s - p.search_s)};
}

std::string percent(double share) {
  return fmt::format("{:.0f} %", 100 * share);
}

/// Two columns; empty for what is not one of its routines.
std::string thesis_cells(std::string_view routine) {
  for (const RoutineRow& row : routine_rows())
    if (routine == fmt::format("*{}*", row.name))
      return fmt::format(" {:.0f}, {:.0f}, {:.0f} | {}, {}, {} |", row.calls[0], row.calls[1], row.calls[2],
                         row.seconds[0], row.seconds[1], row.seconds[2]);
  return " | |";
}

std::string calls_table(const HierarchyStudy& study) {
  std::string text =
      "| routine | here | Image 1 | Image 2 | Image 3 | the thesis: calls | seconds "
      "|\n|---|---|---:|---:|---:|---:|---:|\n";
  const auto row = [&](const char* routine, const char* here, auto value) {
    text += fmt::format("| {} | {} |", routine, here);
    for (size_t i = 0; i < study.images.size(); ++i) text += fmt::format(" {} |", value(i));
    text += thesis_cells(routine) + "\n";
  };
  const auto of = [&](size_t i) -> const RenderProfile& { return study.images[i].profile; };
  const auto ms = [](double s) { return fmt::format("{:.2f} ms", 1e3 * s); };
  row("*ptrace*", "leaves of polygons; polygons in them",
      [&](size_t i) { return fmt::format("{}; {}", of(i).polygon_leaves, of(i).polygons); });
  row("*qtrace*", "leaves of spheres or quadrics; those in them",
      [&](size_t i) { return fmt::format("{}; {}", of(i).curved_leaves, of(i).curved); });
  row("*otrace*", "objects at rest stand in one hierarchy: none", [](size_t) { return "0"; });
  row("*vtrace*", "volumes entered; boxes tested, eight at once",
      [&](size_t i) { return fmt::format("{}; {}", of(i).nodes, of(i).boxes); });
  row("*ndmult*", "rays brought into an object's space; objects at rest need none",
      [](size_t) { return "0"; });
  row("*sqr*", "not counted: roots are taken in lanes", [](size_t) { return ""; });
  row("*ptrace* to *sqr*", "together, in packets of eight", [&](size_t i) { return ms(of(i).search_s); });
  row("*render*", "eye rays", [&](size_t i) { return of(i).eye_rays; });
  row("*wpixel*", "pixels", [&](size_t i) { return of(i).pixels; });
  row("*teval*", "eye and secondary rays", [&](size_t i) { return of(i).eye_rays + of(i).secondary_rays; });
  row("*shade*", "the same; shadow rays", [&](size_t i) {
    return fmt::format("{}; {}", of(i).eye_rays + of(i).secondary_rays, of(i).shadow_rays);
  });
  row("*render* to *shade*", "together: the frame without searching",
      [&](size_t i) { return ms(std::max(0.0, of(i).frame_s - of(i).search_s)); });
  row("*mknod*", "no nodes are made while tracing", [](size_t) { return "0"; });
  row("*readd*", "reading the file; compiling it, with the hierarchy",
      [&](size_t i) { return fmt::format("{}; {}", ms(of(i).load_s), ms(of(i).compile_s)); });
  row("*mmult*", "transforms of object nodes",
      [&](size_t i) { return fmt::format("{}, {:.2f} µs", of(i).object_nodes, 1e6 * of(i).place_s); });
  row("*spixel*", "writing the picture's file", [&](size_t i) { return ms(of(i).write_s); });
  return text + "\n";
}

std::string summary_table(const HierarchyStudy& study) {
  std::string text =
      "| image | intersection | traversal | others | the thesis | primitives | pointers at 15 | the thesis "
      "|\n|---|---:|---:|---:|---|---:|---:|---|\n";
  for (size_t i = 0; i < study.images.size(); ++i) {
    const Summary s = summarize(study, i);
    const ImageRow& thesis = image_rows()[i];
    const double all_s = thesis.intersection_s + thesis.traversal_s + thesis.other_s;
    const HierarchyRun& run = study.run(static_cast<int>(i + 1), "thesis", 15);
    text += fmt::format(
        "| {} | {:.2f} ms, {} | {:.2f} ms, {} | {:.2f} ms, {} | {}, {}, {} | {} | {} | {:.0f}, {:.0f} |\n",
        i + 1, 1e3 * s.intersection_s, percent(s.intersection_s / s.total_s()), 1e3 * s.traversal_s,
        percent(s.traversal_s / s.total_s()), 1e3 * s.other_s, percent(s.other_s / s.total_s()),
        percent(thesis.intersection_s / all_s), percent(thesis.traversal_s / all_s),
        percent(thesis.other_s / all_s), run.primitives, run.pointers, i == 1 ? 58 : thesis.primitives,
        size_row(Scheme::object_volume, static_cast<int>(i + 1), 15).pointers);
  }
  return text + "\n";
}

std::string memory_table(const HierarchyStudy& study) {
  std::string text = "| what | Image 1 | Image 2 | Image 3 |\n|---|---:|---:|---:|\n";
  const auto row = [&](const std::string& what, auto value) {
    text += "| " + what + " |";
    for (size_t i = 0; i < study.images.size(); ++i) text += fmt::format(" {:.0f} |", value(i));
    text += "\n";
  };
  const auto of = [&](size_t i) -> const RenderProfile& { return study.images[i].profile; };
  row("primitives by Table 4.4's formula, nothing shared", [&](size_t i) { return of(i).formula_bytes; });
  row("object/volume at 15 by Table 4.5's", [&](size_t i) { return of(i).hierarchy_bytes; });
  row("**both**", [&](size_t i) { return of(i).formula_bytes + of(i).hierarchy_bytes; });
  row("the thesis: both", [&](size_t i) { return image_rows()[i].storage_bytes; });
  row("the scene's block here, with lights and materials", [&](size_t i) { return of(i).block_bytes; });
  row("code here: the program's file, every command and SIMD target in it",
      [&](size_t i) { return of(i).code_bytes; });
  row("the thesis: code", [](size_t) { return kProgramBytes[0]; });
  row("raster, 3 bytes a pixel (the thesis the same)", [&](size_t i) { return of(i).raster_bytes; });
  row("**block, code and raster**",
      [&](size_t i) { return of(i).block_bytes + of(i).code_bytes + of(i).raster_bytes; });
  row("the thesis: total (Table 4.12)", [](size_t i) { return image_rows()[i].total_bytes; });
  return text + "\n";
}

std::string kinds_table(const HierarchyStudy& study) {
  std::string text =
      "| image | eye | reflected | refracted | shadow | hierarchy | type 1 | type 2 | type 3 |\n"
      "|---|---:|---:|---:|---:|---|---:|---:|---:|\n";
  for (size_t i = 0; i < study.images.size(); ++i) {
    const RayCounts& kinds = study.images[i].kinds;
    const auto share = [&](RayKind kind) { return percent(part(kinds[kind], kinds.total())); };
    for (const char* hierarchy : {"regular", "adaptive", "thesis"}) {
      const KindCosts costs = study.run(static_cast<int>(i + 1), hierarchy, 15).all();
      text +=
          fmt::format("| {} | {} | {} | {} | {} | `{}` | {} | {} | {} |\n", i + 1, share(RayKind::primary),
                      share(RayKind::reflected), share(RayKind::transmitted), share(RayKind::shadow),
                      hierarchy, percent(part(costs.types[0], costs.rays)),
                      percent(part(costs.types[1], costs.rays)), percent(part(costs.types[2], costs.rays)));
    }
  }
  return text + "\n";
}

}  // namespace

std::string profile_text(const HierarchyStudy& study) {
  return "## A profile (Tables 4.8 to 4.10)\n\nOne picture of each image on one core, `--hierarchy thesis "
         "--max-primitives 15`, by the headings of the thesis's profile. Calls are counted by a walk of the "
         "recorded "
         "rays one by one; times are the least of three runs. Rays are searched and shaded eight at a time, "
         "so that no "
         "clock stands between routines: the search was timed alone, with the same rays in packets, and the "
         "rest of "
         "the frame is what remains.\n\n" +
         calls_table(study) +
         "Table 4.10: intersection and traversal are the search's time, divided as Equation 4.5 with the "
         "unit times "
         "below divides it (N_P · T_P, and N_V · T_N + T_O).\n\n" +
         summary_table(study) + "## Memory (Tables 4.11 and 4.12)\n\nBytes.\n\n" + memory_table(study) +
         "Active memory is measured by [working sets](../working-sets/README.md).\n\n## Types of rays "
         "(Figure "
         "4.6)\n\nKinds of rays as they were recorded; and of all of them the three of Figure 4.6: type 1 "
         "\"strikes an "
         "object in the first volume tested\", type 2 passes empty volumes only before it strikes or leaves, "
         "type 3 "
         "tests a full volume in vain. Volumes of `thesis` are never empty, at the cut 15.\n\n" +
         kinds_table(study);
}

std::vector<Relation> profile_relations(const HierarchyStudy& study) {
  std::vector<Relation> relations;
  for (size_t i = 0; i < study.images.size(); ++i) {
    const Summary s = summarize(study, i);
    const RenderProfile& p = study.images[i].profile;
    const ImageRow& thesis = image_rows()[i];
    const double search = (s.intersection_s + s.traversal_s) / s.total_s();
    relations.push_back(
        {fmt::format("Image {}: intersection and traversal take most of a picture (Table 4.10)", i + 1),
         percent((thesis.intersection_s + thesis.traversal_s) /
                 (thesis.intersection_s + thesis.traversal_s + thesis.other_s)),
         percent(search), search > 0.5,
         fmt::format(
             "a ray is searched in {:.0f} ns, in packets of eight, and shading a sample takes {:.0f} ns",
             1e9 * p.search_s / std::max(1.0, static_cast<double>(study.images[i].rays)),
             1e9 * s.other_s / std::max(1.0, static_cast<double>(p.eye_rays + p.secondary_rays)))});
    const double files = (p.load_s + p.write_s) / (p.load_s + p.compile_s + p.frame_s + p.write_s);
    relations.push_back(
        {fmt::format("Image {}: input and output take less than one per cent (4.4.3.1)", i + 1), "< 1 %",
         fmt::format("{:.1f} %", 100 * files), files < 0.01,
         fmt::format(
             "reading {:.1f} ms and writing {:.1f} ms stand beside a frame of {:.1f} ms on one core, which "
             "took the VAX {:.0f} s",
             1e3 * p.load_s, 1e3 * p.write_s, 1e3 * p.frame_s,
             thesis.intersection_s + thesis.traversal_s + thesis.other_s)});
  }
  return relations;
}

}  // namespace rayfarm
