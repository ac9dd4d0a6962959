#include "host/experiments/zones/zone_means.h"

#include <atomic>
#include <cmath>
#include <numbers>
#include <thread>

#include "common/lighting/integrators/integrator.h"
#include "common/lighting/zones/zone_scene.h"
#include "common/lighting/zones/zone_solution.h"
#include "host/experiments/zones/zone_runs.h"

namespace rayfarm {
namespace {

/// Of two halves of the paths.
using Halves = std::array<Color, 2>;

/// Radiance that leaves a zone's side along the normal, the mean over the zone: what a path finds that looks
/// straight down at it from nearby. Surfaces that emit nothing and reflect diffusely.
Halves radiance_by_paths(const ZoneScene& zones, const ZoneGrid& grid, uint32_t cell, uint32_t side,
                         uint32_t samples, Integrator& integrator) {
  const RenderSettings settings = zone_experiment_settings(LightingModel::path, samples);
  const SamplingTables tables(settings, 0);
  const FrameContext context{zones.scene(0), zones.pose(), tables};
  const double above = 1e-4 * zones.map().size();
  RayCounts counts;
  Halves sums{Color(0), Color(0)};
  for (uint32_t first = 0; first < samples; first += kMostPacketRays) {
    const size_t n = std::min<size_t>(kMostPacketRays, samples - first);
    RayPacket rays;
    std::array<SampleId, kMostPacketRays> ids;
    for (size_t i = 0; i < n; ++i) {
      ids[i] = {static_cast<int>(grid.first_cell + cell), static_cast<int>(side),
                first + static_cast<uint32_t>(i)};
      const ZonePoint point = zones.map().point(
          grid, cell, side, tables.sampler.point(ids[i], dimension::kLens), [](uint32_t) { return Vec2(0); });
      const Vec3& normal = point.surface.geometric_normal;
      rays.push_back(point.surface.p + above * normal, -normal);
    }
    std::array<Color, kMostPacketRays> colors;
    integrator.trace(context, rays, std::span(ids).first(n), counts, colors.data());
    for (size_t i = 0; i < n; ++i) sums[ids[i].sample * 2 < samples ? 0 : 1] += colors[i];
  }
  for (Color& sum : sums) sum /= samples / 2.0;
  return sums;
}

}  // namespace

MeansOfZones compare_zone_means(const Scene& scene, const RenderSettings& settings, uint32_t samples) {
  const ZoneScene zones(scene, settings, 0);
  const SolvedZoneLight solved = solve_zone_light(scene, settings);
  const ZonePassSolution solution =
      std::move(decode_zone_solution(solved.bytes, zones.passes(), zones.slot_count())[0]);
  struct Side {
    const ZoneGrid* grid;
    uint32_t cell, side;
    Color zone{0};
    Halves path{};
  };
  std::vector<Side> sides;
  for (const ZoneGrid& grid : zones.map().grids()) {
    if (is_luminaire(scene.materials[grid.material])) continue;
    for (uint32_t cell = 0; cell < grid.cell_count; ++cell)
      for (uint32_t side = 0; side < 2; ++side)
        if (const Power power = solution.total.at(grid.slot(cell, side)); !power.is_zero())
          sides.push_back({&grid,
                           cell,
                           side,
                           solution.quantum.value(power) / (std::numbers::pi * zones.map().area(grid, cell)),
                           {}});
  }
  std::atomic<size_t> next = 0;
  const auto work = [&] {
    const std::unique_ptr<Integrator> integrator = make_integrator(LightingModel::path);
    for (size_t i; (i = next.fetch_add(1)) < sides.size();)
      sides[i].path =
          radiance_by_paths(zones, *sides[i].grid, sides[i].cell, sides[i].side, samples, *integrator);
  };
  std::vector<std::thread> others(std::max(1u, std::thread::hardware_concurrency()) - 1);
  for (std::thread& thread : others) thread = std::thread(work);
  work();
  for (std::thread& thread : others) thread.join();

  MeansOfZones means;
  double squares = 0, noise = 0, sum = 0;
  for (const Side& side : sides) {
    const Color path = (side.path[0] + side.path[1]) / 2.0, apart = side.zone - path,
                halves = (side.path[0] - side.path[1]) / 2.0;
    squares += glm::dot(apart, apart) / 3;
    noise += glm::dot(halves, halves) / 3;
    sum += (path.x + path.y + path.z) / 3;
  }
  means.zones = static_cast<int>(sides.size());
  if (sum > 0) {
    means.rms = std::sqrt(squares * means.zones) / sum;
    means.noise = std::sqrt(noise * means.zones) / sum;
  }
  return means;
}

}  // namespace rayfarm
