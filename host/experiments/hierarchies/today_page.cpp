// Scenes of today, how cost grows, and which hierarchy one would choose now.
#include <fmt/core.h>

#include <algorithm>
#include <map>

#include "host/experiments/hierarchies/hierarchies_page.h"

namespace rayfarm {
namespace {

constexpr std::array kOfThesis{"object", "regular", "adaptive", "thesis"};

const PeerTime* peer_of(const HierarchyStudy& study, const std::string& scene) {
  const auto time =
      std::find_if(study.peer.begin(), study.peer.end(), [&](const PeerTime& p) { return p.scene == scene; });
  return time == study.peer.end() ? nullptr : &*time;
}

/// The fastest of a scene's rows among some hierarchies; nullptr if there is none.
template <typename Names>
const HierarchyRow* fastest(const HierarchyStudy& study, const std::string& scene, const Names& names) {
  const HierarchyRow* best = nullptr;
  for (const HierarchyRow& row : study.rows)
    if (row.scene == scene && std::find(names.begin(), names.end(), row.hierarchy) != names.end() &&
        (!best || row.run.ns_per_ray < best->run.ns_per_ray))
      best = &row;
  return best;
}

std::string scenes_table(const HierarchyStudy& study) {
  std::string text =
      "| scene | hierarchy | primitives | construction | bytes here | N_V or N_O | N_P | rays asked | ns a "
      "ray "
      "|\n|---|---|---:|---:|---:|---:|---:|---:|---:|\n";
  for (const HierarchyRow& row : study.rows)
    if (row.image == 0)
      text += fmt::format("| {} | `{}`{} | {} | {:.3g} s | {:.3g} | {:.1f} | {:.1f} | {} | {:.0f} |\n",
                          row.scene, row.hierarchy, row.setting.empty() ? "" : " " + row.setting,
                          row.run.primitives, row.run.build_cpu_s, row.run.bytes, row.run.volumes_per_ray(),
                          row.run.primitives_per_ray(), row.run.all().rays, row.run.ns_per_ray);
  return text + "\n";
}

std::string growth_table(const HierarchyStudy& study) {
  std::vector<double> numbers;
  for (const GrowthPoint& p : study.growth)
    if (std::find(numbers.begin(), numbers.end(), p.number) == numbers.end()) numbers.push_back(p.number);
  std::string text = "| hierarchy |";
  for (const double number : numbers) text += fmt::format(" {:.0f} |", number);
  text += " grows with |\n|---|";
  for (size_t i = 0; i < numbers.size(); ++i) text += "---:|";
  text += "---|\n";
  for (const char* hierarchy :
       {"brute", "object", "regular", "adaptive", "adaptive-pointers", "thesis", "sah"}) {
    text += fmt::format("| `{}` |", hierarchy);
    const GrowthPoint *first = nullptr, *last = nullptr;
    for (const GrowthPoint& p : study.growth)
      if (p.hierarchy == hierarchy) {
        text += fmt::format(" {:.1f}; {:.0f} ns; {:.3g} s |", p.tests_per_ray, p.ns_per_ray, p.build_cpu_s);
        if (!first) first = &p;
        last = &p;
      }
    const double exponent = first && last != first ? std::log(last->ns_per_ray / first->ns_per_ray) /
                                                         std::log(last->number / first->number)
                                                   : 0;
    text += fmt::format(" n^{:.2f} |\n", exponent);
  }
  return text + "\n";
}

std::string choice_table(const HierarchyStudy& study) {
  std::vector<std::string> scenes;
  for (const HierarchyRow& row : study.rows)
    if (std::find(scenes.begin(), scenes.end(), row.scene) == scenes.end()) scenes.push_back(row.scene);
  std::string text =
      "| scene | the fastest of the thesis's four | `sah` is | testing all is | Embree, times our `sah`'s "
      "speed |\n"
      "|---|---|---|---|---|\n";
  std::map<std::string, int> wins;
  int sah_wins = 0;
  for (const std::string& scene : scenes) {
    const HierarchyRow *best = fastest(study, scene, kOfThesis),
                       *sah = fastest(study, scene, std::array{"sah"}),
                       *brute = fastest(study, scene, std::array{"brute"});
    ++wins[best->hierarchy];
    sah_wins += sah->run.ns_per_ray < best->run.ns_per_ray ? 1 : 0;
    const PeerTime* peer = peer_of(study, scene);
    text += fmt::format(
        "| {} | `{}`{}, {:.0f} ns a ray | {:.2f} times as fast | {:.3g} times as slow | {} |\n", scene,
        best->hierarchy, best->setting.empty() ? "" : " " + best->setting, best->run.ns_per_ray,
        best->run.ns_per_ray / sah->run.ns_per_ray, brute->run.ns_per_ray / best->run.ns_per_ray,
        peer ? fmt::format("{:.2f}", peer->rayfarm_ns / peer->peer_ns) : "not measured");
  }
  text += "\n";
  for (const auto& [hierarchy, count] : wins)
    text += fmt::format("Of the thesis's four `{}` is the fastest on {} of {} scenes. ", hierarchy, count,
                        scenes.size());
  return text +
         fmt::format(
             "`sah`, the same volumes divided by the surface area heuristic, is faster than all four on {} "
             "of {}.\n\n",
             sah_wins, scenes.size());
}

/// What speaks for each, in this page's numbers.
std::string reasons(const HierarchyStudy& study) {
  std::string text;
  const auto growth = [&](const char* hierarchy, auto of) {
    double least = 0, most = 0;
    for (const GrowthPoint& p : study.growth)
      if (p.hierarchy == hierarchy) {
        if (least == 0) least = of(p);
        most = of(p);
      }
    return std::pair{least, most};
  };
  const auto ns = [](const GrowthPoint& p) { return p.ns_per_ray; };
  const auto tests = [](const GrowthPoint& p) { return p.tests_per_ray; };
  const auto build = [](const GrowthPoint& p) { return p.build_cpu_s; };
  const auto [list_least, list_most] = growth("object", ns);
  const auto [grid_least, grid_most] = growth("regular", ns);
  const auto [tree_least, tree_most] = growth("adaptive", tests);
  const auto [sah_least, sah_most] = growth("sah", ns);
  text += fmt::format(
      "- `object`, where a scene is of many small objects: nothing is built but a volume for each object and "
      "group, and "
      "what moves is only placed anew. But a ray tests all of an object whose volume it meets: {:.0f} ns on "
      "the smallest "
      "ground and {:.0f} on the largest.\n",
      list_least, list_most);
  text += fmt::format(
      "- `regular`, among cells, where primitives are of one size and lie evenly: {:.0f} and {:.0f} ns on "
      "the same grounds, "
      "and {:.3g} s for building the largest, where `adaptive` takes {:.3g} and `sah` {:.3g}. One crowded "
      "cell spoils it "
      "(Image 1).\n",
      grid_least, grid_most, growth("regular", build).second, growth("adaptive", build).second,
      growth("sah", build).second);
  text += fmt::format(
      "- `adaptive`, among cells, where a scene is crowded in places: {:.1f} and {:.1f} tests a ray on the "
      "smallest and the "
      "largest ground. Each step looks for its cell from the root, and then in a hash table of 1000 places, "
      "whose chains "
      "grow with the scene: on the largest a ray takes {:.0f} ns, and {:.0f} where nodes have pointers "
      "(`--octree-data "
      "pointers`).\n",
      tree_least, tree_most, growth("adaptive", ns).second, growth("adaptive-pointers", ns).second);
  text += fmt::format(
      "- `thesis`, object/volume, where its rule is asked for; else `sah`, which divides by expected cost "
      "and keeps as well "
      "what it built while objects move: {:.0f} and {:.0f} ns a ray, where `thesis` takes {:.0f} and {:.0f}. "
      "It is the "
      "default.\n",
      sah_least, sah_most, growth("thesis", ns).first, growth("thesis", ns).second);
  return text + "\n";
}

}  // namespace

std::string today_text(const HierarchyStudy& study) {
  std::string text =
      "## Over the cut\n\n![tests and time over the cut](cuts.svg)\n\nEvery fourth ray of each image. "
      "`cuts.dat` has the numbers.\n\n## Over the number of primitives\n\nHilly ground of equal triangles, "
      "each hierarchy "
      "as it is without further options: primitives that a ray tests, its time, and CPU time of building; "
      "the last "
      "column is the power of the number of primitives by which the time grew from the first size to the "
      "last.\n\n" +
      growth_table(study) +
      "![tests and time over the number of primitives](growth.svg)\n\n`object` has one object here, so that "
      "it tests what "
      "`brute` tests. Both were asked few of the rays.\n\n## Scenes of today\n\n";
  text +=
      "`tests/bench/write_scenes.py` writes them: a mesh of 70,000 triangles, a terrain of a million, and "
      "100 copies "
      "of an object. Where all primitives are tested, few of the rays were asked.\n\n" +
      scenes_table(study);
  for (const std::string& file : study.missing) text += fmt::format("There was no `{}`.\n\n", file);
  text += "## Which now, and when\n\n" + choice_table(study);
  text +=
      study.peer.empty()
          ? "Embree was not measured: `build/tests/bench/same_rays` (built with `-DRAYFARM_BENCH=ON` where "
            "Embree 3 is "
            "installed) writes its times to `embree.csv` in this folder, and the experiment reads them.\n\n"
          : "Embree 3 was asked the same rays, one by one on one core, in turn with `sah` "
            "(`build/tests/bench/same_rays`): its hits are in float and ours in double. It knows no "
            "quadrics, so "
            "that Image 2 is without it.\n\n";
  return text + reasons(study);
}

}  // namespace rayfarm
