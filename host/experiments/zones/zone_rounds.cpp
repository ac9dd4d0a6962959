#include "host/experiments/zones/zone_rounds.h"

#include <fmt/core.h>

#include <cmath>

#include "common/lighting/zones/zone_scene.h"
#include "common/lighting/zones/zone_solution.h"
#include "host/experiments/page.h"

namespace rayfarm {

ZoneStudy study_rounds(const ZoneWork& work) {
  constexpr double kSize = 0.2, kRays = 1e6, kTolerance = 0.001;
  ZoneStudy study;
  Table table{"rounds", {"scene", "shoot", "rounds", "rays", "unsent", "cpu_s"}, {}};
  struct Case {
    const char* file;
    ZoneShooting shooting;
  };
  double rays_of_all = 0, rounds_of_all = 0;
  for (const Case& c :
       {Case{"goral_room.yaml", ZoneShooting::all}, Case{"goral_room.yaml", ZoneShooting::one},
        Case{"zones/closed_room.yaml", ZoneShooting::all},
        Case{"zones/closed_room.yaml", ZoneShooting::one}}) {
    const char* const word = kZoneShootingWords[static_cast<size_t>(c.shooting)];
    tell_zones(fmt::format("rounds in {}, --shoot {}", c.file, word));
    const PicturedScene scene = work.scene(c.file);
    RenderSettings settings = zone_experiment_settings(LightingModel::zonal, 1);
    settings.zones.size = work.size(kSize);
    settings.zones.rays = work.rays(kRays);
    settings.zones.tolerance = kTolerance;
    settings.zones.shooting = c.shooting;
    const SolvedZoneLight solved = solve_zone_light(scene.scene(), settings);
    const ZoneScene zones(scene.scene(), settings, 0);
    const ZonePassSolution solution =
        std::move(decode_zone_solution(solved.bytes, zones.passes(), zones.slot_count())[0]);
    const double rays = static_cast<double>(solved.rays[RayKind::diffuse]),
                 rounds = static_cast<double>(solution.rounds),
                 unsent = solution.unsent.total() / solution.primary.total();
    table.rows.push_back({std::string(c.file), std::string(word), rounds, rays, unsent, solved.cpu_s});
    std::string& data = study.data["rounds.dat"];
    // Of thousands of rounds every plot has room for some hundreds.
    const size_t step = 1 + solved.course.size() / 300;
    for (size_t i = 0; i < solved.course.size(); i += step) {
      const UnsentPower& at = solved.course[i];
      if (at.rounds > 0 || at.rays > 0 || i + 1 == solved.course.size() || solved.course[i + 1].rays > 0)
        data += fmt::format("{} {} {}\n", at.rounds + 1, at.rays, at.unsent);
    }
    data += fmt::format("{} {} {}\n\n\n", rounds + 1, rays, unsent);
    if (c.shooting == ZoneShooting::all) {
      rays_of_all = rays;
      rounds_of_all = rounds;
      continue;
    }
    study.checks.push_back({fmt::format("{}: one zone at a time", c.file),
                            "the same light, a round for each zone",
                            fmt::format("{:.0f} rounds for {:.0f}, {:.2f} times the rays", rounds,
                                        rounds_of_all, rays / rays_of_all),
                            unsent <= kTolerance && rounds > rounds_of_all});
  }
  study.section =
      fmt::format(
          "\n## Unsent power over rounds\n\n"
          "In a round all zones send what they have (`--shoot all`, Jacobi's order), or the fullest "
          "does (`--shoot one`, Southwell's). Rays have the same power either way. Zones are {:.2g} "
          "wide; rounds end when {} of all power is unsent.\n\n",
          work.size(kSize), percent(kTolerance)) +
      markdown(table) +
      "\nWith all zones at a time unsent power falls by the mean albedo in each round, and by what "
      "leaves the room. How many rays there are follows from the power that is sent in all, which is "
      "the same in any order. One zone at a time gives an early picture; but the host waits for each "
      "zone, and a net for each of its round trips.\n\n"
      "![unsent power over rays](unsent_rays.svg) ![unsent power over rounds](unsent_rounds.svg)\n";
  study.tables.push_back(std::move(table));
  return study;
}

}  // namespace rayfarm
