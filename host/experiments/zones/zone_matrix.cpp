#include <fmt/core.h>

#include <cmath>

#include "common/lighting/zones/form_factors.h"
#include "common/lighting/zones/zone_solution.h"
#include "host/experiments/page.h"
#include "host/experiments/zones/zone_rounds.h"

namespace rayfarm {
namespace {

/// From one square to another: the mean over zones by area, of both sides together.
double square_factor(const Scene& scene, const RenderSettings& settings) {
  const ZoneScene zones(scene, settings, 0);
  const Sampler sampler({SamplingPattern::sobol, 1, settings.seed}, 0);
  const FormFactorTracer tracer(zones, sampler, settings);
  const ZoneMap& map = zones.map();
  const ZoneGrid& from = map.grids()[0];
  RayCounts counts;
  double sum = 0, area = 0;
  for (uint32_t cell = 0; cell < from.cell_count; ++cell) {
    area += map.area(from, cell);
    for (uint32_t side = 0; side < 2; ++side) {
      const FormFactorRow row = tracer.trace(
          from.slot(cell, side), [] {}, counts);
      for (const FormFactorRow::Seen& seen : row.seen)
        if (map.place_of_slot(seen.slot).grid == 1)
          sum += map.area(from, cell) * static_cast<double>(seen.weight) / static_cast<double>(row.total);
    }
  }
  return sum / area;
}

void compare_squares(const ZoneWork& work, ZoneStudy& study) {
  struct Pair {
    const char *name, *points;
    double exact;
  };
  // In closed form.
  constexpr Pair kPairs[] = {{"aligned, 1 apart", "[0,0,1],[0,1,1],[1,1,1],[1,0,1]", 0.199825},
                             {"perpendicular, common edge", "[0,0,0],[0,1,0],[0,1,1],[0,0,1]", 0.200044}};
  constexpr double kRays = 1e6;
  Table table{"form factors of unit squares", {"squares", "way", "zones", "factor", "exact", "off"}, {}};
  for (const Pair& pair : kPairs) {
    const PicturedScene scene = work.scene_of(fmt::format(
        "view: {{location: [3, 3, 3], look_at: [0, 0, 0]}}\nmaterials: {{wall: {{lambertian: 0.7}}}}\n"
        "scene:\n  - {{material: wall, polygon: {{points: [[0,0,0],[1,0,0],[1,1,0],[0,1,0]]}}}}\n"
        "  - {{material: wall, polygon: {{points: [{}]}}}}\n",
        pair.points));
    RenderSettings settings = zone_experiment_settings(LightingModel::radiosity, 1);
    settings.zones.size = 3;
    settings.zones.rays = work.rays(kRays);
    const auto add = [&](const std::string& way, double zones) {
      const double factor = square_factor(scene.scene(), settings), off = factor / pair.exact - 1;
      table.rows.push_back({std::string(pair.name), way, zones, factor, pair.exact, off});
      return off;
    };
    // Of four sides of zones two look at the other; each has a quarter of the rays.
    const double rays = settings.zones.rays / 4.0, sigma = std::sqrt((1 - pair.exact) / pair.exact / rays);
    const double by_rays = add("rays", 1);
    study.checks.push_back(
        {fmt::format("form factor of unit squares, {}, by rays", pair.name),
         fmt::format("{} in 3σ", pair.exact),
         fmt::format("{:.6f}, {:.1f}σ off", pair.exact * (1 + by_rays), std::abs(by_rays) / sigma),
         std::abs(by_rays) < 3 * sigma});
    settings.zones.form_factors = FormFactors::hemicube;
    for (const int side : {1, 3, 7}) {
      settings.zones.size = 1.0 / side;
      settings.zones.hemicube_cells = 56;  // edges of these squares lie between pixels
      const double off = add("hemicube", side * side);
      if (side == 7)
        study.checks.push_back(
            {fmt::format("the same by hemicubes at 7 × 7 middles"), fmt::format("{} ± 1 %", pair.exact),
             fmt::format("{:.5f}, {} off", pair.exact * (1 + off), percent(off)), std::abs(off) < 0.01});
    }
  }
  study.section +=
      "Form factors of unit squares. A hemicube sees from a zone's middle, and the mean over more middles "
      "comes "
      "nearer:\n\n" +
      markdown(table) + "\n";
  study.tables.push_back(std::move(table));
}

struct ZoneWay {
  const char* name;
  LightingModel model;
  ZoneShooting shooting;
  FormFactors factors;
};
constexpr ZoneWay kWays[] = {
    {"matrix, form factors by rays", LightingModel::radiosity, ZoneShooting::all, FormFactors::rays},
    {"matrix, hemicubes", LightingModel::radiosity, ZoneShooting::all, FormFactors::hemicube},
    {"all zones at a time", LightingModel::zonal, ZoneShooting::all, FormFactors::rays},
    {"one zone at a time", LightingModel::zonal, ZoneShooting::one, FormFactors::rays}};

}  // namespace

ZoneStudy study_matrix(const ZoneWork& work) {
  constexpr double kSize = 0.25, kRays = 1e6, kTolerance = 1e-3;
  constexpr int kSeeds = 5;
  tell_zones("the matrix and progressive refinement");
  ZoneStudy study;
  const PicturedScene scene = work.scene("goral_room.yaml");
  Table table{
      "ways to solve", {"way", "rays", "cpu_s", "indirect_light", "sigma", "from_matrix", "in_sigma"}, {}};
  double matrix = 0, matrix_sigma = 0, matrix_s = 0;
  std::string zones_text;
  for (const ZoneWay& way : kWays) {
    std::vector<double> light;
    double rays = 0, cpu_s = 0;
    for (int seed = 1; seed <= kSeeds; ++seed) {
      RenderSettings settings = zone_experiment_settings(way.model, 1);
      settings.seed = static_cast<uint64_t>(seed);
      settings.zones.size = work.size(kSize);
      settings.zones.rays = work.rays(kRays);
      settings.zones.samples = 64;
      settings.zones.tolerance = kTolerance;
      settings.zones.shooting = way.shooting;
      settings.zones.form_factors = way.factors;
      const ZoneScene zones(scene.scene(), settings, 0);
      const SolvedZoneLight solved = solve_zone_light(scene.scene(), settings);
      const ZonePassSolution solution =
          std::move(decode_zone_solution(solved.bytes, zones.passes(), zones.slot_count())[0]);
      Power indirect;
      solution.total.for_each([&](uint64_t slot, const Power& total) {
        indirect += total;
        indirect -= solution.direct.at(slot);
      });
      const Color value = solution.quantum.value(indirect);
      light.push_back(value.x + value.y + value.z);
      rays += static_cast<double>(solved.rays.total()) / kSeeds;
      cpu_s += solved.cpu_s / kSeeds;
      zones_text = fmt::format("{}", zones.map().cell_count());
    }
    double mean = 0, squares = 0;
    for (const double x : light) mean += x / kSeeds;
    for (const double x : light) squares += (x - mean) * (x - mean);
    const double sigma = std::sqrt(squares / (kSeeds - 1) / kSeeds);
    if (&way == kWays) {
      matrix = mean;
      matrix_sigma = sigma;
      matrix_s = cpu_s;
    }
    // Rounds leave a part unsent, which zones never get.
    const double apart = mean - matrix, both = std::hypot(sigma, matrix_sigma),
                 left = way.model == LightingModel::zonal ? kTolerance * mean : 0,
                 in_sigma = both > 0 ? std::max(0.0, std::abs(apart) - left) / both : 0;
    table.rows.push_back({std::string(way.name), rays, cpu_s, mean, sigma, apart / matrix, in_sigma});
    if (&way != kWays && way.factors == FormFactors::rays)
      study.checks.push_back({fmt::format("{} against the matrix", way.name), "same in 3σ",
                              fmt::format("{:.1f}σ ({}), {:.2f} times its CPU", in_sigma,
                                          percent(apart / matrix), cpu_s / matrix_s),
                              in_sigma < 3});
  }
  study.section =
      fmt::format(
          "\n## The full matrix and progressive refinement\n\n"
          "Equation 2.6 of the thesis, solved by Gauss and Seidel's sweeps, against rounds, in Goral's "
          "room: {} zones, {:.2g} wide, {} rays of a round or for all form factors. Light that zones "
          "reflect beyond what comes straight from the source, the mean of {} solutions with random "
          "numbers of their own, and its standard error. What rounds leave unsent, {} of all, is no "
          "difference.\n\n",
          zones_text, work.size(kSize), work.rays(kRays), kSeeds, percent(kTolerance)) +
      markdown(table) + "\n";
  study.tables.push_back(std::move(table));
  compare_squares(work, study);
  return study;
}

}  // namespace rayfarm
