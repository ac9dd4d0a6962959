#include <fmt/core.h>

#include <cmath>
#include <optional>

#include "common/hierarchy/traverser.h"
#include "common/lighting/zones/zone_scene.h"
#include "common/scene/camera.h"
#include "host/experiments/page.h"
#include "host/experiments/zones/zone_scenes.h"

namespace rayfarm {
namespace {

constexpr ZoneView kViews[] = {ZoneView::smooth, ZoneView::direct, ZoneView::gather};
constexpr double kSamples = 64, kReferenceSamples = 1024;

/// Where a picture shows directional zones.
CountedPixels find_directional(const PicturedScene& scene, const ZoneScene& zones) {
  const int width = scene.width_px(), height = scene.height_px();
  const Camera camera = make_camera(scene.scene(), 0, width, height);
  CountedPixels counted;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Hit hit = closest_hit(zones.scene(0), zones.pose(), camera.ray(x + 0.5, y + 0.5));
      const ZoneGrid* const grid = hit.is_hit() ? zones.map().grid_of(hit) : nullptr;
      counted.push_back(grid && grid->store.direction_cells > 0);
    }
  return counted;
}

struct FigureZones {
  const char* name;
  double size, rays;  ///< 0: as a render does without a word
};
constexpr FigureZones kUsual{"usual", 0, 0};
/// As its first lines have it.
constexpr FigureZones kOfTwoFloors{"0.25 wide, 24 million rays", 0.25, 24e6};

struct Figure {
  const char *name, *file;
  double asked;
  bool is_of_directions;           ///< only what directional zones show counts
  std::vector<FigureZones> zones;  ///< the last of them is asked to be as near to paths as that
};

/// Bytes of sums of a zone's two sides, for each kind of zone that there is.
std::string bytes_text(const ZoneScene& zones) {
  std::map<uint64_t, uint64_t> zones_of;  // by sums of a side
  for (const ZoneGrid& grid : zones.map().grids())
    if (grid.store.is_any()) zones_of[grid.store.slots()] += grid.cell_count;
  std::string text;
  for (const auto& [slots, count] : zones_of)
    text +=
        fmt::format("{}{} zones with {} ({:.0f} bytes a side)", text.empty() ? "" : ", ", count,
                    slots == 1 ? "one sum" : fmt::format("{} sums", slots), kZoneSumBytes * double(slots));
  if (zones.media().cell_count() > 0)
    text += fmt::format(", {} zones of media with {} sums", zones.media().cell_count(),
                        zones.media().slot_count());
  return text;
}

}  // namespace

ZoneStudy study_zone_figures(const ZoneWork& work) {
  ZoneStudy study;
  study.section = fmt::format(
      "\n## Directional zones and a medium\n\n"
      "Figures 4, 7 and 8 of Shirley, Sung and Brown (1991): the scenes are ours, as theirs are shown in "
      "small "
      "pictures alone. Blocks of 16 × 16 pixels of pictures {} wide with {} samples a pixel, against `path` "
      "with "
      "{}. Usual zones and rays are what a render takes without a word; directional zones share a round's "
      "rays "
      "among many directions and want more of them, and may be larger. Of Figure 4 only the floors "
      "count.\n\n",
      work.width_px(), work.samples(kSamples), 2 * (work.samples(kReferenceSamples) / 2));
  Table table{
      "figures", {"figure", "zones", "view", "blocks", "noise_of_path", "solve_cpu_s", "picture_cpu_s"}, {}};
  for (const Figure& figure :
       {Figure{"Fig. 4, directional floors", "zones/two_floors.yaml", 0.05, true, {kUsual, kOfTwoFloors}},
        Figure{"Fig. 7, a gallery", "zones/gallery.yaml", 0.03, false, {kUsual}},
        Figure{"Fig. 8, the gallery with a medium", "zones/gallery_mist.yaml", 0.03, false, {kUsual}}}) {
    tell_zones(figure.name);
    const PicturedScene scene = work.scene(figure.file);
    std::optional<PathReference> reference;
    double best = INFINITY;
    std::string best_view;
    for (const FigureZones& chosen : figure.zones) {
      RenderSettings settings = zone_experiment_settings(LightingModel::zonal, work.samples(kSamples));
      settings.zones.rays = work.rays(chosen.rays > 0 ? chosen.rays : settings.zones.rays);
      if (chosen.size > 0 || work.size(1) > 1)
        settings.zones.size = work.size(chosen.size > 0 ? chosen.size : 0.1);
      const ZoneScene zones(scene.scene(), settings, 0);
      if (!reference)
        reference =
            make_path_reference(scene, work.samples(kReferenceSamples), 0,
                                figure.is_of_directions ? find_directional(scene, zones) : CountedPixels());
      const SolvedZoneLight solved = solve_zone_light(scene.scene(), settings);
      best = INFINITY;
      for (const ZoneView view : kViews) {
        settings.zones.view = view;
        const double before = cpu_time();
        const FloatPicture picture = scene.render(settings, 0, solved.bytes);
        const double cpu_s = cpu_time() - before;
        const double error = picture_error(scene, picture, *reference).blocks;
        const std::string word = kZoneViewWords[static_cast<size_t>(view)];
        table.rows.push_back({std::string(figure.name), std::string(chosen.name), word, error,
                              reference->block_noise, solved.cpu_s, cpu_s});
        // `gather` follows what a shiny floor reflects by rays, and reads its tables only where these lead.
        if (figure.is_of_directions && view == ZoneView::gather) continue;
        if (error < best) {
          best = error;
          best_view = word;
        }
      }
      study.section += fmt::format("- {} (`{}`), zones {}: {}.\n", figure.name, figure.file, chosen.name,
                                   bytes_text(zones));
    }
    const FigureZones& asked = figure.zones.back();
    study.checks.push_back({fmt::format("{}, blocks, `{}`{}", figure.name, best_view,
                                        asked.size > 0 ? fmt::format(", zones {}", asked.name) : ""),
                            fmt::format("{} of `path`", percent(figure.asked)), percent(best),
                            best <= figure.asked});
  }
  study.section += "\n" + markdown(table);
  study.tables.push_back(std::move(table));
  return study;
}

}  // namespace rayfarm
