#pragma once
// Zones solved in the test's own process.
#include <numbers>
#include <numeric>
#include <random>

#include "common/lighting/renderer.h"
#include "common/lighting/zones/zone_solver.h"
#include "tests/unit/probe.h"

namespace rayfarm::test {

/// As a farm does: the items of each stage in an order of their own, each by one of `nodes` tracers.
inline std::vector<std::byte> solve_zones(const Scene& scene, const RenderSettings& settings,
                                          size_t nodes = 1, uint32_t order = 0, int frame = 0) {
  const std::unique_ptr<ZoneSolver> solver = make_zone_solver(scene, settings, frame);
  std::vector<std::unique_ptr<ZoneTracer>> tracers;
  for (size_t i = 0; i < nodes; ++i) tracers.push_back(make_zone_tracer(scene, settings, frame));
  std::mt19937 random(order);
  while (const auto stage = solver->next_stage()) {
    for (const auto& tracer : tracers) tracer->begin(stage->data);
    std::vector<uint64_t> items(stage->items());
    std::iota(items.begin(), items.end(), 0);
    if (order > 0)
      for (size_t i = items.size(); i-- > 1;) std::swap(items[i], items[random() % (i + 1)]);
    for (size_t i = 0; i < items.size(); ++i) {
      const uint64_t first = items[i] * stage->units_per_item;
      solver->add(items[i], tracers[i % nodes]
                                ->work(first, std::min(stage->units_per_item, stage->units - first), [] {})
                                .bytes);
    }
  }
  return solver->solution();
}

/// A scene and its zones, solved.
struct SolvedZones {
  SolvedZones(const std::string& text, const RenderSettings& with)
      : compiled(compile(load_yaml(text))),
        settings(with),
        bytes(solve_zones(compiled.scene, settings)),
        zones(compiled.scene, settings, 0),
        solution(std::move(decode_zone_solution(bytes, 1, zones.slot_count())[0])) {}

  /// Reflected power per area of a side of a grid's cell.
  Color radiosity(const ZoneGrid& grid, uint32_t cell = 0, uint32_t side = 0) {
    return solution.quantum.value(solution.total[grid.slot(cell, side)]) / zones.map().area(grid, cell);
  }
  /// Means over whole grids, by area.
  Color mean_radiosity(const ZoneGrid& grid, uint32_t side = 0) {
    Color power(0);
    double area = 0;
    for (uint32_t cell = 0; cell < grid.cell_count; ++cell) {
      if (!(zones.map().area(grid, cell) > 0)) continue;
      power += radiosity(grid, cell, side) * zones.map().area(grid, cell);
      area += zones.map().area(grid, cell);
    }
    return power / area;
  }
  std::vector<float> picture(int width_px, int height_px, uint32_t samples = 1) {
    RenderSettings s = settings;
    s.width_px = width_px;
    s.height_px = height_px;
    s.crop = {0, 0, width_px, height_px};
    s.samples = samples;
    s.pixel_format = PixelFormat::float32;
    Renderer renderer(compiled.scene, s);
    renderer.set_zones(0, bytes);
    const RenderedPixels rendered = renderer.render(0, s.crop, [] {});
    std::vector<float> values(rendered.pixels.size() / sizeof(float));
    std::memcpy(values.data(), rendered.pixels.data(), rendered.pixels.size());
    return values;
  }

  CompiledScene compiled;
  RenderSettings settings;
  std::vector<std::byte> bytes;
  ZoneScene zones;
  ZonePassSolution solution;
};

/// A closed room whose ceiling shines with an exitance of 1 too; all reflect 0.7. And what its faces reflect,
/// by hand with F of opposite faces 0.199825 and of those with a common edge 0.200044.
inline std::string shining_cube() {
  std::string text = view_text() +
                     "materials: {wall: {lambertian: 0.7}, top: {luminaire: {color: 0.7, emission: " +
                     fmt::format("{:.17g}", 1 / std::numbers::pi) + "}}}\nscene:\n" + room("wall");
  const size_t top = text.find("material: wall", text.find("[-1,1,-1],[1,1,-1]") - 60);
  return text.replace(top, 14, "material: top");
}
inline constexpr double kOfShiningCube[] = {0.40926, 0.28655, 0.40938, 0.40938, 0.40938, 0.40938};

inline RenderSettings zone_settings(double size, uint32_t rays, ZoneView view = ZoneView::flat) {
  RenderSettings settings;
  settings.lighting = LightingModel::zonal;
  limit_by_depth(settings, kPathDepth);
  settings.zones.size = size;
  settings.zones.rays = rays;
  settings.zones.view = view;
  return settings;
}

}  // namespace rayfarm::test
