#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "common/lighting/zones/zone_scene.h"
#include "common/lighting/zones/zone_solution.h"
#include "host/experiments/page.h"
#include "host/experiments/zones/zone_scenes.h"

namespace rayfarm {
namespace {

using std::numbers::pi;

const std::string kView =
    "view: {location: [0, 0, 0.9], look_at: [0, 0, -1], field_of_view: 70, aspect: 1}\n";

struct Solved {
  ZonePassSolution solution;
  std::vector<std::vector<Color>> radiosity;  ///< of each grid's cells, front: reflected power per area
};

Solved solve(const PicturedScene& scene, const RenderSettings& settings) {
  const ZoneScene zones(scene.scene(), settings, 0);
  Solved solved{std::move(decode_zone_solution(solve_zone_light(scene.scene(), settings).bytes,
                                               zones.passes(), zones.slot_count())[0]),
                {}};
  for (const ZoneGrid& grid : zones.map().grids()) {
    auto& cells = solved.radiosity.emplace_back();
    for (uint32_t cell = 0; cell < grid.cell_count; ++cell)
      cells.push_back(solved.solution.quantum.value(solved.solution.total.at(grid.slot(cell, 0))) /
                      zones.map().area(grid, cell));
  }
  return solved;
}

/// Six squares that face inward, side 2.
std::string closed_box(const std::string& material, const std::string& top) {
  std::string text;
  for (const char* points :
       {"[-1,-1,-1],[-1,-1,1],[1,-1,1],[1,-1,-1]", "[-1,1,-1],[1,1,-1],[1,1,1],[-1,1,1]",
        "[-1,-1,-1],[1,-1,-1],[1,1,-1],[-1,1,-1]", "[-1,-1,1],[-1,1,1],[1,1,1],[1,-1,1]",
        "[-1,-1,-1],[-1,1,-1],[-1,1,1],[-1,-1,1]", "[1,-1,-1],[1,-1,1],[1,1,1],[1,1,-1]"})
    text += fmt::format("  - {{material: {}, polygon: {{points: [{}]}}}}\n",
                        std::string_view(points).starts_with("[-1,1,-1],[1,1") ? top : material, points);
  return text;
}

RenderSettings settings_of(const ZoneWork& work, double size, double rays, ZonePrimary primary) {
  RenderSettings settings = zone_experiment_settings(LightingModel::zonal, 1);
  settings.zones.size = size;
  settings.zones.rays = work.rays(rays);
  settings.zones.samples = work.samples(4096);
  settings.zones.primary = primary;
  return settings;
}

void add_furnace(const ZoneWork& work, ZoneStudy& study) {
  constexpr double kAlbedo = 0.5;
  const PicturedScene scene = work.scene_of(
      kView +
      fmt::format("materials: {{wall: {{luminaire: {{color: {}, emission: 1}}}}}}\nscene:\n", kAlbedo) +
      closed_box("wall", "wall"));
  for (const ZonePrimary primary : {ZonePrimary::direct, ZonePrimary::shot}) {
    const Solved solved = solve(scene, settings_of(work, 1, 4e6, primary));
    double worst = 0;
    for (const auto& cells : solved.radiosity)
      for (const Color& cell : cells)
        worst = std::max(worst, std::abs((cell.x + pi) * (1 - kAlbedo) / pi - 1));
    study.checks.push_back({fmt::format("furnace, closed, ρ = {}, `--zone-primary {}`: zones", kAlbedo,
                                        kZonePrimaryWords[static_cast<size_t>(primary)]),
                            "E / (1 − ρ) ± 0.5 %", fmt::format("{} off at the most", percent(worst)),
                            worst <= 0.005});
  }
}

void add_cube(const ZoneWork& work, ZoneStudy& study) {
  const PicturedScene scene = work.scene_of(
      kView +
      fmt::format(
          "materials: {{wall: {{lambertian: 0.7}}, top: {{luminaire: {{color: 0.7, emission: {:.17g}}}}}}}\n"
          "scene:\n",
          1 / pi) +
      closed_box("wall", "top"));
  for (const LightingModel model : {LightingModel::zonal, LightingModel::radiosity}) {
    RenderSettings settings = settings_of(work, 3, 4e6, ZonePrimary::shot);
    settings.lighting = model;
    const Solved solved = solve(scene, settings);
    const double bottom = solved.radiosity[0][0].x, top = 1 + solved.radiosity[1][0].x;
    double sides = 0;
    for (size_t i = 2; i < 6; ++i) sides += solved.radiosity[i][0].x / 4;
    const double worst = std::max(
        {std::abs(top / 1.28655 - 1), std::abs(bottom / 0.40926 - 1), std::abs(sides / 0.40938 - 1)});
    study.checks.push_back({fmt::format("cube, a zone on each face, ρ = 0.7, the top shines, `{}`",
                                        model == LightingModel::zonal ? "zonal" : "radiosity"),
                            "1.28655 top, 0.40926 bottom, 0.40938 sides",
                            fmt::format("{:.5f}, {:.5f}, {:.5f}", top, bottom, sides), worst <= 0.005});
    Power balance = solved.solution.absorbed;
    balance += solved.solution.escaped;
    balance += solved.solution.unsent;
    if (model == LightingModel::zonal)
      study.checks.push_back({"balance of the same, in integers", "emitted = absorbed + escaped + unsent",
                              balance == solved.solution.primary ? "equal" : "different",
                              balance == solved.solution.primary});
  }
}

/// A shaft between perfect mirrors, 1 wide, whose floor shines and takes all that comes back, open above:
/// what escapes is what gets through an endless slab.
double through_slab(const ZoneWork& work, double absorption, double scattering) {
  std::string text =
      kView +
      fmt::format(
          "materials: {{mirror: {{diffuse: 0, ambient: 0, reflect: 1}}, floor: {{luminaire: {{color: 0, "
          "emission: 1}}}}}}\nmedia: [{{box: {{min: [0,0,0], max: [1,1,1]}}, absorption: {}, scattering: "
          "{}}}]\n"
          "scene:\n  - {{material: floor, polygon: {{points: [[0,0,0],[0,0,1],[1,0,1],[1,0,0]]}}}}\n",
          absorption, scattering);
  for (const char* points : {"[0,0,0],[1,0,0],[1,2,0],[0,2,0]", "[0,0,1],[0,2,1],[1,2,1],[1,0,1]",
                             "[0,0,0],[0,2,0],[0,2,1],[0,0,1]", "[1,0,0],[1,0,1],[1,2,1],[1,2,0]"})
    text += fmt::format("  - {{material: mirror, polygon: {{points: [{}]}}}}\n", points);
  RenderSettings settings = settings_of(work, work.size(0.05), 1e5, ZonePrimary::shot);
  settings.zones.samples = 4;  // sources shoot; there is nothing to measure
  settings.zones.tolerance = 2e-4;
  limit_by_depth(settings, kMostDepth);
  const Solved solved = solve(work.scene_of(text), settings);
  return solved.solution.escaped.total() / solved.solution.primary.total();
}

void add_slabs(const ZoneWork& work, ZoneStudy& study) {
  struct Slab {
    double depth, white, absorbing;
  };
  Table table{"slabs", {"optical_depth", "white", "white_exact", "absorbing", "absorbing_exact"}, {}};
  for (const Slab& slab : {Slab{0.5, 0.704, 0.4432}, Slab{1, 0.553, 0.2194}, Slab{2, 0.390, 0.0603}}) {
    const double white = through_slab(work, 0, slab.depth), absorbing = through_slab(work, slab.depth, 0);
    table.rows.push_back({slab.depth, white, slab.white, absorbing, slab.absorbing});
    study.checks.push_back(
        {fmt::format("slab, white and isotropic, τ = {}: diffuse light through", slab.depth),
         fmt::format("{:.3f} ± 1 %", slab.white), fmt::format("{:.4f}", white),
         std::abs(white / slab.white - 1) <= 0.01});
    study.checks.push_back({fmt::format("slab, absorbing, τ = {}: diffuse light through", slab.depth),
                            fmt::format("2 E₃(τ) = {:.4f}", slab.absorbing), fmt::format("{:.4f}", absorbing),
                            std::abs(absorbing / slab.absorbing - 1) <= 0.01});
  }
  study.tables.push_back(std::move(table));
}

}  // namespace

ZoneStudy study_known_light(const ZoneWork& work) {
  tell_zones("light that is known");
  ZoneStudy study;
  add_furnace(work, study);
  add_cube(work, study);
  add_slabs(work, study);
  study.section =
      "\n## Light that is known\n\n"
      "Furnaces, the cube and slabs of the first table are closed rooms of side 2, and a shaft between "
      "perfect "
      "mirrors, 1 wide and open above, with the medium in its lower half: light that leaves it has gone "
      "through an "
      "endless slab. The unit tests hold the same numbers with fewer rays (`Zones.*`, `Radiosity.*`, "
      "`ZonesOfMedia.*`).\n\n" +
      markdown(study.tables[0]);
  return study;
}

}  // namespace rayfarm
