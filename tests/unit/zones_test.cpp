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
  RenderSettings settings = zone_settings(3, 1'000'000);
  settings.zones.samples = 4096;
  SolvedZones solved(test::shining_cube(), settings);
  const auto grids = solved.zones.map().grids();
  ASSERT_EQ(grids.size(), 6u);
  for (size_t i = 0; i < 6; ++i)
    EXPECT_NEAR(solved.radiosity(grids[i]).x, test::kOfShiningCube[i], 0.004) << i;
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

/// Mean colour of a small picture.
Color mean_of(const std::vector<float>& values) {
  Color sum(0);
  for (size_t i = 0; i < values.size(); ++i) sum[static_cast<int>(i % 3)] += values[i];
  return sum / (static_cast<double>(values.size()) / 3);
}

/// Of a picture of 16 × 16 pixels.
Color mean_of_paths(const Scene& scene, uint32_t samples) {
  RenderSettings paths = test::picture_settings(16, 16, LightingModel::path);
  limit_by_depth(paths, kPathDepth);
  paths.samples = samples;
  const RenderedPixels rendered = Renderer(scene, paths).render(0, paths.crop, [] {});
  std::vector<float> values(rendered.pixels.size() / sizeof(float));
  std::memcpy(values.data(), rendered.pixels.data(), rendered.pixels.size());
  return mean_of(values);
}

TEST(ZoneViews, ShowWhatPathsFind) {
  // A room with a lamp, and in it what zones keep by directions, a mirror and glass: all views have the mean
  // of paths, which judge them.
  std::string text =
      "view: {location: [0, 0, 0.9], look_at: [0, -0.3, -1], field_of_view: 80, aspect: 1}\n"
      "materials:\n  wall: {lambertian: [0.7, 0.5, 0.3]}\n  lamp: {luminaire: {color: 0, emission: 8}}\n"
      "  mirror: {conductor: {metal: silver}}\n  gold: {conductor: {metal: gold, exponent: 15}}\n"
      "  glass: {dielectric: {index: 1.5}}\nscene:\n"
      "  - {material: lamp, polygon: {points: "
      "[[-0.4,0.98,-0.4],[0.4,0.98,-0.4],[0.4,0.98,0.4],[-0.4,0.98,0.4]]}}\n"
      "  - {material: gold, sphere: {center: [0.5,-0.6,-0.4], radius: 0.35}}\n"
      "  - {material: mirror, sphere: {center: [-0.5,-0.6,-0.4], radius: 0.35}}\n"
      "  - {material: glass, sphere: {center: [0,-0.75,0.1], radius: 0.2}}\n" +
      room("wall");
  RenderSettings settings = zone_settings(0.2, 60'000);
  SolvedZones solved(text, settings);
  const Color expected = mean_of_paths(solved.compiled.scene, 512);
  for (const ZoneView view : {ZoneView::flat, ZoneView::smooth, ZoneView::direct, ZoneView::gather}) {
    SCOPED_TRACE(kZoneViewWords[static_cast<size_t>(view)]);
    solved.settings.zones.view = view;
    const Color mean = mean_of(solved.picture(16, 16, 64));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c] / expected[c], 1, 0.03);
  }
}

TEST(ZoneViews, ShotLightIsNotAskedForTwice) {
  // A panel whose zones shoot and a bulb that zones measure: the view `direct` takes off what shadow rays
  // find, and no more, whichever zones send first.
  const std::string text =
      "view: {location: [0, 0, 0.9], look_at: [0, -0.3, -1], field_of_view: 80, aspect: 1}\n"
      "lights: [{falloff: true, position: [0.5, 0.2, 0.3], color: 0.4}]\n"
      "materials:\n  wall: {lambertian: 0.6}\n  lamp: {luminaire: {color: 0, emission: 3}}\nscene:\n"
      "  - {material: lamp, polygon: {points: "
      "[[-0.5,0.98,-0.5],[0.5,0.98,-0.5],[0.5,0.98,0.5],[-0.5,0.98,0.5]]}}\n" +
      room("wall");
  Color expected(0);
  for (const ZoneShooting shooting : {ZoneShooting::all, ZoneShooting::one}) {
    RenderSettings settings = zone_settings(0.5, 30'000, ZoneView::smooth);
    settings.zones.primary = ZonePrimary::shot;
    settings.zones.shooting = shooting;
    settings.zones.tolerance = 0.01;
    SolvedZones solved(text, settings);
    if (shooting == ZoneShooting::all) expected = mean_of(solved.picture(16, 16, 16));
    solved.settings.zones.view = ZoneView::direct;
    EXPECT_NEAR(mean_of(solved.picture(16, 16, 64)).x / expected.x, 1, 0.03);
  }
}

TEST(ZoneViews, KeptAndFollowedLobesShareAShadowRay) {
  // Figure 7 has such floors: a polish too sharp for zones over boards that they keep. In the view `direct`
  // both ask for the lamp, in all rays of a packet at once, and a step has room for one shadow ray of each.
  SolvedZones solved(
      "view: {location: [0, 0.5, 0.9], look_at: [0, -1, -0.3], field_of_view: 60, aspect: 1}\n"
      "materials:\n  wall: {polished: {color: [0.6, 0.4, 0.3], index: 1.5, exponent: 300}}\n"
      "  lamp: {luminaire: {color: 0, emission: 8}}\nscene:\n"
      "  - {material: lamp, polygon: {points: "
      "[[-0.4,0.98,-0.4],[0.4,0.98,-0.4],[0.4,0.98,0.4],[-0.4,0.98,0.4]]}}\n" +
          room("wall"),
      zone_settings(0.4, 60'000, ZoneView::direct));
  const Color expected = mean_of_paths(solved.compiled.scene, 256),
              mean = mean_of(solved.picture(16, 16, 64));
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c] / expected[c], 1, 0.03);
}

TEST(Zones, LightThatNeverComesToRestIsRefused) {
  RenderSettings settings = zone_settings(1, 1'000);
  settings.zones.samples = 4;
  EXPECT_THROW(SolvedZones(shining_room(1, "1"), settings), std::runtime_error);
}

/// A shaft between perfect mirrors, 1 wide, whose floor shines and takes all that comes back, open above:
/// what escapes of what is shot is what gets through an endless slab.
double through_slab(const std::string& coefficients) {
  std::string text = test::view_text() +
                     "materials: {mirror: {diffuse: 0, ambient: 0, reflect: 1}, floor: "
                     "{luminaire: {color: 0, emission: 1}}}\n"
                     "media: [{box: {min: [0,0,0], max: [1,1,1]}, " +
                     coefficients +
                     "}]\nscene:\n"
                     "  - {material: floor, polygon: {points: [[0,0,0],[0,0,1],[1,0,1],[1,0,0]]}}\n";
  for (const char* points : {"[0,0,0],[1,0,0],[1,2,0],[0,2,0]", "[0,0,1],[0,2,1],[1,2,1],[1,0,1]",
                             "[0,0,0],[0,2,0],[0,2,1],[0,0,1]", "[1,0,0],[1,0,1],[1,2,1],[1,2,0]"})
    text += fmt::format("  - {{material: mirror, polygon: {{points: [{}]}}}}\n", points);
  RenderSettings settings = zone_settings(0.05, 30'000);
  settings.zones.primary = ZonePrimary::shot;
  settings.zones.tolerance = 5e-4;
  limit_by_depth(settings, kMostDepth);
  SolvedZones solved(text, settings);
  return solved.solution.escaped.total() / solved.solution.primary.total();
}

TEST(ZonesOfMedia, SlabsLetThroughWhatTheyShould) {
  // 2 E₃(τ) of diffuse light where nothing is scattered; where all is, evenly, 0.704, 0.553, 0.390 at τ of
  // 0.5, 1 and 2 (zonal.md, section 5).
  EXPECT_NEAR(through_slab("absorption: 1, scattering: 0"), 0.2194, 0.003);
  EXPECT_NEAR(through_slab("absorption: 0, scattering: 0.5"), 0.704, 0.007);
  EXPECT_NEAR(through_slab("absorption: 0, scattering: 1"), 0.553, 0.006);
  EXPECT_NEAR(through_slab("absorption: 0, scattering: 2"), 0.390, 0.004);
}

TEST(ZonesOfMedia, OneScatteringIsAskedForAtAPointOfEachRay) {
  // Thin, a point light Φ at a distance h from a ray, from a to b: κs Φ / (16π² h) (atan(b/h) - atan(a/h))
  // (zonal.md, section 5). With a second box behind, which absorbs alone, and a third that scatters, too.
  SolvedZones solved(
      "view: {location: [-5, 0, 0], look_at: [0, 0, 0], field_of_view: 0.01, aspect: 1}\n"
      "lights: [{falloff: true, position: [0, 1.5, 0], color: 4}]\n"
      "media:\n  - {box: {min: [-1,-3,-3], max: [2,3,3]}, scattering: 0.001}\n"
      "  - {box: {min: [2,-3,-3], max: [3,3,3]}, absorption: 0.0001}\n"
      "  - {box: {min: [3,-3,-3], max: [4,3,3]}, scattering: 0.004}\nscene: []\n",
      zone_settings(1, 1'000, ZoneView::direct));
  const double h = 1.5, first = std::atan(2 / h) + std::atan(1 / h),
               second = std::atan(4 / h) - std::atan(3 / h);
  EXPECT_NEAR(mean_of(solved.picture(4, 4, 256)).x / ((0.001 * first + 0.004 * second) / (pi * h)), 1, 0.02);
}

TEST(ZonesOfMedia, FurnaceWithAWhiteMedium) {
  // Closed, ω = 1: walls and medium show E / (1 - ρ) wherever one looks, whatever the phase function.
  for (const char* g : {"0", "0.5"}) {
    SCOPED_TRACE(g);
    RenderSettings settings = zone_settings(0.4, 60'000, ZoneView::smooth);
    settings.zones.primary = ZonePrimary::shot;
    SolvedZones solved(
        "view: {location: [0.3, 0.2, 0.5], look_at: [0, 0, -1], field_of_view: 70, aspect: 1}\n"
        "media: [{box: {min: [-1,-1,-1], max: [1,1,1]}, absorption: 0, scattering: 1, g: " +
            std::string(g) +
            "}]\n"
            "materials: {wall: {luminaire: {color: 0.5, emission: 1}}}\nscene:\n" +
            room("wall"),
        settings);
    const std::vector<float> picture = solved.picture(8, 8, 4);
    EXPECT_NEAR(mean_of(picture).x, 2, 0.02);
    for (const float value : picture) EXPECT_NEAR(value, 2, 0.25);
  }
}

}  // namespace
}  // namespace rayfarm
