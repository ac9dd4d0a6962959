// Progressive refinement by rays that carry power (Shirley, Sung and Brown 1991, section 3).
#include <gtest/gtest.h>

#include <numbers>

#include "tests/unit/probe.h"
#include "tests/unit/solved_zones.h"

namespace rayfarm {
namespace {

using std::numbers::pi;
using test::SolvedZones;
using test::zone_settings;

/// A closed room of side 2 whose material shines inward.
std::string shining_room(double albedo, const std::string& emission) {
  return test::view_text() +
         fmt::format("materials: {{wall: {{luminaire: {{color: {}, emission: {}}}}}}}\nscene:\n", albedo,
                     emission) +
         room("wall");
}

/// Three walls.
std::string half_room() {
  const std::string whole = room("wall");
  return whole.substr(0, whole.find("  - ", whole.size() / 2));
}

TEST(Zones, FurnaceHasTheSameLightEverywhere) {
  // Closed, one exitance E = π and one albedo ρ: B = E / (1 - ρ), of which E is emitted.
  for (const ZonePrimary primary : {ZonePrimary::direct, ZonePrimary::shot}) {
    RenderSettings settings = zone_settings(1, 250'000);
    settings.zones.primary = primary;
    settings.zones.samples = 512;
    SolvedZones solved(shining_room(0.5, "1"), settings);
    for (const ZoneGrid& grid : solved.zones.map().grids()) {
      EXPECT_EQ(grid.cell_count, 4u);
      for (uint32_t cell = 0; cell < 4; ++cell) {
        EXPECT_NEAR(solved.radiosity(grid, cell).x / pi, 1, 0.02);
        EXPECT_EQ(solved.radiosity(grid, cell, 1), Color(0));  // outside nothing shines
      }
      EXPECT_NEAR(solved.mean_radiosity(grid).x / pi, 1, 0.01);
    }
  }
}

TEST(Zones, CubeWithAZonePerFace) {
  // F of opposite faces 0.199825, of those with a common edge 0.200044: the equations of six faces, by hand.
  std::string text = test::view_text() +
                     "materials: {wall: {lambertian: 0.7}, top: {luminaire: {color: 0.7, emission: " +
                     fmt::format("{:.17g}", 1 / pi) + "}}}\nscene:\n" + room("wall");
  const size_t top = text.find("material: wall", text.find("[-1,1,-1],[1,1,-1]") - 60);
  text.replace(top, 14, "material: top");
  RenderSettings settings = zone_settings(3, 1'000'000);
  settings.zones.samples = 4096;
  SolvedZones solved(text, settings);
  const auto grids = solved.zones.map().grids();
  ASSERT_EQ(grids.size(), 6u);
  const double expected[] = {0.40926, 0.28655, 0.40938, 0.40938, 0.40938, 0.40938};
  for (size_t i = 0; i < 6; ++i) EXPECT_NEAR(solved.radiosity(grids[i]).x, expected[i], 0.004) << i;
}

TEST(Zones, SphereMixesAllLight) {
  // Inside a sphere F_ij = A_j / 4πr² from everywhere: B_j = E_j + ρ_j H, H = Σ A E / Σ A (1 - ρ). One sphere
  // whose zones are all alike: B - E = ρ E / (1 - ρ).
  RenderSettings settings = zone_settings(0.7, 40'000);
  settings.zones.samples = 64;
  SolvedZones solved(test::view_text() +
                         "materials: {m: {luminaire: {color: 0.6, emission: [1, 2, 0], inward: true}}}\n"
                         "scene: [{material: m, sphere: {center: [5, 6, 7], radius: 1}}]\n",
                     settings);
  const ZoneGrid& grid = solved.zones.map().grids()[0];
  EXPECT_GT(grid.cell_count, 30u);
  double area = 0;
  for (uint32_t cell = 0; cell < grid.cell_count; ++cell) {
    area += solved.zones.map().area(grid, cell);
    const Color b = solved.radiosity(grid, cell, 1) / pi;
    EXPECT_NEAR(b.x, 1.5, 0.12);
    EXPECT_NEAR(b.y, 3, 0.24);
    EXPECT_EQ(b.z, 0);
    EXPECT_EQ(solved.radiosity(grid, cell, 0), Color(0));
  }
  EXPECT_NEAR(area, 4 * pi, 1e-6);
  EXPECT_NEAR(solved.mean_radiosity(grid, 1).x / pi, 1.5, 0.01);
}

TEST(Zones, PowerBalancesToTheQuantum) {
  for (const ZoneShooting shooting : {ZoneShooting::all, ZoneShooting::one}) {
    RenderSettings settings = zone_settings(0.7, 5'000);
    settings.zones.shooting = shooting;
    settings.zones.tolerance = 0.05;
    SolvedZones solved(test::view_text() + kMixedRoom + half_room(), settings);
    Power balance = solved.solution.absorbed;
    balance += solved.solution.escaped;
    balance += solved.solution.unsent;
    EXPECT_EQ(balance, solved.solution.primary);
    EXPECT_FALSE(solved.solution.escaped.is_zero());
    EXPECT_LE(solved.solution.unsent.total(), 0.05 * solved.solution.primary.total());
  }
}

TEST(Zones, CutOrderAndNodesDoNotShow) {
  const std::string text = test::view_text() + kMixedRoom + room("wall");
  RenderSettings settings = zone_settings(0.7, 3'000);
  settings.zones.samples = 4;
  const CompiledScene compiled = compile(test::load_yaml(text));
  const std::vector<std::byte> alone = test::solve_zones(compiled.scene, settings);
  settings.zones.batch = 7;
  EXPECT_EQ(test::solve_zones(compiled.scene, settings, 3, 5), alone);
  settings.zones.batch = 1000;
  EXPECT_EQ(test::solve_zones(compiled.scene, settings, 2, 9), alone);
}

TEST(Zones, OneZoneAtATimeComesToTheSame) {
  RenderSettings settings = zone_settings(1, 60'000);
  settings.zones.samples = 64;
  settings.zones.shooting = ZoneShooting::one;
  settings.zones.tolerance = 0.01;
  SolvedZones solved(shining_room(0.5, "1"), settings);
  for (const ZoneGrid& grid : solved.zones.map().grids())
    EXPECT_NEAR(solved.mean_radiosity(grid).x / pi, 0.99, 0.02);
}

}  // namespace
}  // namespace rayfarm
