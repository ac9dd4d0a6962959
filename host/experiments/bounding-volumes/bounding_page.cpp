#include "host/experiments/bounding-volumes/bounding_page.h"

#include <fmt/core.h>

#include "host/experiments/bounding-volumes/bounding_relations.h"
#include "host/experiments/bounding-volumes/weghorst_tables.h"

namespace rayfarm {
namespace {

using weghorst::Environment;
using weghorst::kEnvironments;

double ratio(double a, double b) {
  return b > 0 ? a / b : 0;
}

double per_ray(uint64_t count, const PhaseCost& phase) {
  return ratio(static_cast<double>(count), static_cast<double>(phase.rays));
}

/// A line of the tables, with a cell for each combination. Where the paper printed nothing there is nothing.
template <typename Value>
std::string line(const std::string& name, const Value& value) {
  std::string text = "| " + name + " |";
  for (size_t c = 0; c < weghorst::kCombinationCount; ++c) text += " " + value(c) + " |";
  return text + "\n";
}

std::string printed(double value, const char* format) {
  return value > 0 ? fmt::format(fmt::runtime(format), value) : std::string();
}

std::string phases(const Environment& theirs, const EnvironmentRun& ours) {
  const CombinationRun& control = ours.runs[weghorst::kC];
  std::string text = "| |";
  for (const char* name : weghorst::kCombinations) text += fmt::format(" {} |", name);
  text += "\n|---|---:|---:|---:|---:|---:|---:|---:|---:|\n";
  const auto share = [&](const char* name, const weghorst::Row& row, auto seconds) {
    text += line(fmt::format("{}, 1984, %", name), [&](size_t c) { return printed(row[c], "{:.1f}"); });
    text += line(fmt::format("{}, here, %", name), [&](size_t c) {
      return fmt::format("{:.1f}", 100 * ratio(seconds(ours.runs[c]), ours.runs[c].total_s()));
    });
  };
  text += line("**total, 1984**", [&](size_t c) { return printed(theirs.total[c], "**{:.2f}**"); });
  text += line("**total, here**", [&](size_t c) {
    return fmt::format("**{:.2f}**", ratio(ours.runs[c].total_s(), control.total_s()));
  });
  text += line("search alone, here", [&](size_t c) {
    return fmt::format("{:.2f}", ratio(ours.runs[c].search_s(), control.search_s()));
  });
  text += line("b·B + i·I, here", [&](size_t c) {
    return fmt::format("{:.2f}", ratio(search_cost_ns(ours, c), search_cost_ns(ours, weghorst::kC)));
  });
  share("tree", theirs.tree, [](const CombinationRun& r) { return r.tree_s(); });
  share("shadow", theirs.shadow, [](const CombinationRun& r) { return r.shadow.s; });
  share("buffer", theirs.buffer, [](const CombinationRun& r) { return r.buffer_s; });
  share("colour", theirs.colour, [](const CombinationRun& r) { return r.colour_s(); });
  share("miscellaneous", theirs.miscellaneous, [](const CombinationRun& r) { return r.write_s; });
  const auto counted = [&](const char* of, auto phase) {
    text += line(fmt::format("volumes / items / primitives a ray: {}", of), [&](size_t c) {
      const PhaseCost& cost = phase(ours.runs[c]);
      return fmt::format("{:.1f} / {:.2f} / {:.1f}", per_ray(cost.counts.bounding_volumes(), cost),
                         per_ray(cost.counts.objects, cost), per_ray(cost.counts.primitives(), cost));
    });
  };
  counted("eye", [](const CombinationRun& r) -> const PhaseCost& { return r.eye; });
  if (control.secondary.rays > 0)
    counted("secondary", [](const CombinationRun& r) -> const PhaseCost& { return r.secondary; });
  counted("shadow", [](const CombinationRun& r) -> const PhaseCost& { return r.shadow; });
  text +=
      line("pixels that differ", [&](size_t c) { return fmt::format("{}", ours.runs[c].differing_pixels); });
  return text + "\n";
}

std::string environment_text(const Environment& theirs, const EnvironmentRun& ours) {
  const CombinationRun &control = ours.runs[weghorst::kC], &best = ours.runs[weghorst::kSHZ];
  std::string text = fmt::format(
      "## {}: Table {}\n\nC took {} h in 1984 and {:.2f} s here. {} eye rays, {} secondary, {} shadow rays; "
      "{}. The trees "
      "of rays are {:.2f} deep on average. A primitive in an item costs {:.1f} ns. Beyond the table, "
      "relative to C: "
      "SH with the buffer's hits as bounds alone {:.2f}; SHZ with item buffers of the lights too, which end "
      "{} shadow "
      "rays, {:.2f} (SHZ: {:.2f}).\n\n",
      theirs.title, theirs.table, theirs.hours, control.total_s(), control.eye.rays, control.secondary.rays,
      control.shadow.rays,
      theirs.depth > 0
          ? fmt::format("depth {}", theirs.depth)
          : fmt::format("rays of a weight below {} cut ({})", kAdaptiveWeight, ours.rays[RayTally::cut]),
      ours.rays.average_depth(), ours.primitive_ns, ratio(ours.bound_s + best.write_s, control.total_s()),
      ours.shadowed_by_items, ratio(ours.light_buffer_s + best.write_s, control.total_s()),
      ratio(best.total_s(), control.total_s()));
  return text + phases(theirs, ours);
}

std::string composite(const BoundingResults& results) {
  std::string text = "| |";
  for (const char* name : weghorst::kCombinations) text += fmt::format(" {} |", name);
  text += "\n|---|---:|---:|---:|---:|---:|---:|---:|---:|\n";
  for (size_t e = 0; e < kEnvironments.size(); ++e) {
    const EnvironmentRun& ours = results.environments[e];
    text += line(fmt::format("{}, 1984", kEnvironments[e].title),
                 [&](size_t c) { return printed(kEnvironments[e].total[c], "{:.2f}"); });
    text += line(fmt::format("{}, here", kEnvironments[e].title), [&](size_t c) {
      return fmt::format("{:.2f}", ratio(ours.runs[c].total_s(), ours.runs[weghorst::kC].total_s()));
    });
  }
  return text + "\n";
}

std::string relations_table(const BoundingResults& results, size_t& held, size_t& all) {
  std::string text = "| relation | 1984 | here | | why |\n|---|---|---|---|---|\n";
  for (const BoundingRelation& r : bounding_relations(results)) {
    ++all;
    held += r.holds ? 1 : 0;
    text += fmt::format("| {} | {} | {} | {} | {} |\n", r.what, r.theirs, r.ours,
                        r.holds ? "holds" : "**does not hold**", r.holds ? std::string() : r.why);
  }
  return text + "\n";
}

}  // namespace

Table bounding_table(const BoundingResults& results) {
  Table table{"bounding_volumes",
              {"environment",
               "frame",
               "combination",
               "total",
               "total_1984",
               "render_s",
               "tree_s",
               "eye_s",
               "shadow_s",
               "buffer_s",
               "colour_s",
               "write_s",
               "eye_rays",
               "secondary_rays",
               "shadow_rays",
               "eye_volumes",
               "eye_items",
               "eye_primitives",
               "secondary_volumes",
               "secondary_items",
               "secondary_primitives",
               "shadow_volumes",
               "shadow_items",
               "shadow_primitives",
               "primitive_ns",
               "search_cost_ns",
               "average_depth",
               "rays_cut",
               "differing_pixels"},
              {}};
  for (size_t e = 0; e < results.environments.size(); ++e) {
    const EnvironmentRun& ours = results.environments[e];
    for (size_t c = 0; c < ours.runs.size(); ++c) {
      const CombinationRun& r = ours.runs[c];
      std::vector<TableCell> row{std::string(kEnvironments[e].scene),
                                 double(kEnvironments[e].frame),
                                 r.name,
                                 ratio(r.total_s(), ours.runs[weghorst::kC].total_s()),
                                 kEnvironments[e].total[c],
                                 r.render_s,
                                 r.tree_s(),
                                 r.eye.s,
                                 r.shadow.s,
                                 r.buffer_s,
                                 r.colour_s(),
                                 r.write_s};
      for (const PhaseCost* phase : {&r.eye, &r.secondary, &r.shadow}) row.emplace_back(double(phase->rays));
      for (const PhaseCost* phase : {&r.eye, &r.secondary, &r.shadow}) {
        row.emplace_back(per_ray(phase->counts.bounding_volumes(), *phase));
        row.emplace_back(per_ray(phase->counts.objects, *phase));
        row.emplace_back(per_ray(phase->counts.primitives(), *phase));
      }
      row.emplace_back(ours.primitive_ns);
      row.emplace_back(search_cost_ns(ours, c));
      row.emplace_back(ours.rays.average_depth());
      row.emplace_back(double(ours.rays[RayTally::cut]));
      row.emplace_back(double(r.differing_pixels));
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

std::string bounding_page(const BoundingResults& results) {
  size_t held = 0, all = 0;
  const std::string relations = relations_table(results, held, all);
  std::string text = fmt::format(
      "# Bounding volumes\n\nWritten by `rayfarm experiment bounding-volumes`; `deploy/reproduce "
      "bounding-volumes` "
      "runs it again. Tables II to IX of Weghorst, Hooper and Greenberg (*Improved Computational Methods for "
      "Ray "
      "Tracing*, ACM Transactions on Graphics 3, 1, 1984) on their environments, [rebuilt]"
      "(../../../scenes/hierarchies/README.md): counts of items, polygons and lights are theirs, places and "
      "views "
      "are not. {} × {} pixels with a ray through each corner, in Whitted's model, on one core.\n\n"
      "**C** items in bounding spheres (`--hierarchy object --bounds sphere --clusters none`); **S** in the "
      "sphere, "
      "box or cylinder with the least factor × volume (`--bounds best`); **H** within clusters, the scene's "
      "groups "
      "(`--clusters groups`); **Z** with the item buffer, trusted as theirs is (`--item-buffer trusted`): an "
      "item is "
      "an object of the scene with all its primitives, and a ray through a corner of a pixel tests the one "
      "that a "
      "z-buffer found there.\n\n",
      results.width_px, results.height_px);
  text += fmt::format(
      "How times were taken: the picture as a whole, and its rays, written down once, again by kinds: eye "
      "and "
      "secondary rays (tree), shadow rays, and the making of the buffer, the least processor time of several "
      "runs each. "
      "Colour is what "
      "the whole takes beside them: shading, and all that is done for rays but the search. Miscellaneous is "
      "the writing "
      "of the PNG. Counts don't depend on a machine: volumes are tests of bounding volumes, items those of "
      "what is in an "
      "object's volume (b and i of Equation 1), primitives what is tested in items. b·B + i·I takes the "
      "factors {:g}, "
      "{:g} and {:g} ns of sphere, box and cylinder (`tests/bench/volume_factors`) and for I the measured "
      "time of a "
      "primitive times their number; it leaves out the buffer. The scene as a whole has a volume, too, which "
      "a ray that sees the background misses; theirs may have had none.\n\n",
      kVolumeFactors[0], kVolumeFactors[1], kVolumeFactors[2]);
  text += "| volume | factor in use, ns a test | measured in this run |\n|---|---:|---:|\n";
  for (size_t kind = 0; kind < kVolumeKinds; ++kind)
    text += fmt::format("| {} | {:g} | {:.1f} |\n", kVolumeKindNames[kind], kVolumeFactors[kind],
                        results.factors[kind].ns);
  text += "\n![totals](totals.svg)\n\n![phases](phases.svg)\n\n## Table IX\n\n" + composite(results);
  text += fmt::format(
              "## What holds\n\n{} of {} relations. The wheel of the last two is `wheel.yaml`: its thickness "
              "isn't stated, and "
              "was chosen so that the ratio from the side comes near theirs; the one from the front is then "
              "given.\n\n",
              held, all) +
          relations;
  for (size_t e = 0; e < kEnvironments.size(); ++e)
    text += environment_text(kEnvironments[e], results.environments[e]);
  return text + "`bounding_volumes.csv` has all numbers.\n";
}

}  // namespace rayfarm
