// The full matrix (Goral and others 1984; the thesis's 2.2.5, Equation 2.6) and its form factors, by rays and
// by hemicubes (Cohen and Greenberg 1985).
#include "common/lighting/zones/form_factors.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/unit/probe.h"
#include "tests/unit/solved_zones.h"

namespace rayfarm {
namespace {

using std::numbers::pi;
using test::SolvedZones;

RenderSettings matrix_settings(double size, uint32_t rays) {
  RenderSettings settings = test::zone_settings(size, rays);
  settings.lighting = LightingModel::radiosity;
  return settings;
}

/// What zones of a scene see.
struct Sights {
  Sights(const std::string& text, const RenderSettings& settings)
      : compiled(compile(test::load_yaml(test::view_text() + text))),
        zones(compiled.scene, settings, 0),
        sampler({SamplingPattern::sobol, 1, settings.seed}, 0),
        tracer(zones, sampler, settings) {}

  /// From one grid to another: the mean over zones by area, of both sides together.
  double factor(size_t from, size_t to) {
    const ZoneMap& map = zones.map();
    const ZoneGrid &a = map.grids()[from], &b = map.grids()[to];
    double sum = 0, area = 0;
    for (uint32_t cell = 0; cell < a.cell_count; ++cell) {
      area += map.area(a, cell);
      for (uint32_t side = 0; side < 2; ++side) {
        const FormFactorRow row = tracer.trace(
            a.slot(cell, side), [] {}, counts);
        for (const FormFactorRow::Seen& seen : row.seen)
          if (map.place_of_slot(seen.slot).grid == static_cast<uint32_t>(&b - map.grids().data()))
            sum += map.area(a, cell) * static_cast<double>(seen.weight) / static_cast<double>(row.total);
      }
    }
    return sum / area;
  }

  CompiledScene compiled;
  ZoneScene zones;
  Sampler sampler;
  FormFactorTracer tracer;
  RayCounts counts;
};

const std::string kWhite = "materials: {wall: {lambertian: 0.7}}\nscene:\n";
const std::string kFloorOfFactors =
    "  - {material: wall, polygon: {points: [[0,0,0],[1,0,0],[1,1,0],[0,1,0]]}}\n";
const std::string kAligned =
    kWhite + kFloorOfFactors + "  - {material: wall, polygon: {points: [[0,0,1],[0,1,1],[1,1,1],[1,0,1]]}}\n";
const std::string kPerpendicular =
    kWhite + kFloorOfFactors + "  - {material: wall, polygon: {points: [[0,0,0],[0,1,0],[0,1,1],[0,0,1]]}}\n";

// Of unit squares, in closed form: 0.199825 aligned at distance 1, 0.200044 with a common edge.

TEST(FormFactors, ByRaysAreRightInThreeSigma) {
  constexpr double kRays = 40'000;
  const RenderSettings settings = matrix_settings(3, static_cast<uint32_t>(4 * kRays));
  const double sigma = std::sqrt(0.2 * 0.8 / kRays);
  EXPECT_NEAR(Sights(kAligned, settings).factor(0, 1), 0.199825, 3 * sigma);
  EXPECT_NEAR(Sights(kPerpendicular, settings).factor(0, 1), 0.200044, 3 * sigma);
}

TEST(FormFactors, HemicubesTellAPointsForTheWhole) {
  // From the middle of a square 0.2395; the mean over 3 × 3 middles 0.2033, over 7 × 7 0.2004.
  RenderSettings settings = matrix_settings(3, 1);
  settings.zones.form_factors = FormFactors::hemicube;
  settings.zones.hemicube_cells = 96;
  EXPECT_NEAR(Sights(kAligned, settings).factor(0, 1), 0.2395, 0.0003);
  settings.zones.size = 1.0 / 3;
  EXPECT_NEAR(Sights(kAligned, settings).factor(0, 1), 0.2033, 0.0003);
  settings.zones.size = 1.0 / 7;
  settings.zones.hemicube_cells = 56;  // edges of squares between pixels, not through their middles
  EXPECT_NEAR(Sights(kAligned, settings).factor(0, 1), 0.2004, 0.0006);
  EXPECT_NEAR(Sights(kPerpendicular, settings).factor(0, 1), 0.200044, 0.01 * 0.200044);
}

/// A sphere of two parts, one of a quarter of its area, that shine inward.
const std::string kParts = R"(materials:
  cap: {luminaire: {color: 0.3, emission: 2, inward: true}}
  rest: {luminaire: {color: 0.7, emission: 0.5, inward: true}}
scene:
  - {material: cap, quadric: {coefficients: [1,1,1,0,0,0,0,0,0,-1], planes: [[0,0,-1,-0.5]]}}
  - {material: rest, quadric: {coefficients: [1,1,1,0,0,0,0,0,0,-1], planes: [[0,0,1,0.5]]}}
)";

TEST(FormFactors, InsideASphereAreAreas) {
  // F_ij = A_j / 4πr², whatever sends.
  Sights sights(kParts, matrix_settings(0.7, 1'200'000));
  const ZoneMap& map = sights.zones.map();
  const ZoneGrid &cap = map.grids()[0], &rest = map.grids()[1];
  EXPECT_GT(std::abs(map.area(cap, 0) / map.area(rest, 0) - 1), 0.1);  // sizes differ
  const FormFactorRow row = sights.tracer.trace(
      cap.slot(1, 1), [] {}, sights.counts);
  EXPECT_EQ(row.escaped, 0u);
  const auto rays = static_cast<double>(row.total);
  for (const FormFactorRow::Seen& seen : row.seen) {
    const SlotPlace place = map.place_of_slot(seen.slot);
    const double f = map.area(map.grids()[place.grid], place.cell) / (4 * pi);
    EXPECT_EQ(place.side, 1u);
    EXPECT_NEAR(static_cast<double>(seen.weight) / rays, f, 4 * std::sqrt(f / rays));
  }
}

TEST(Radiosity, SphereOfUnlikeZonesMixesAllLight) {
  // B_j = E_j + ρ_j H, H = Σ A E / Σ A (1 - ρ) = π (2 + 3 · 0.5) / (0.7 + 3 · 0.3). F_ij taken for F_ji would
  // give light by the receiver's size.
  RenderSettings settings = matrix_settings(0.7, 200'000);
  settings.zones.samples = 64;
  SolvedZones solved(test::view_text() + kParts, settings);
  const auto grids = solved.zones.map().grids();
  EXPECT_NEAR(solved.mean_radiosity(grids[0], 1).x / pi, 0.3 * 2.1875, 0.3 * 2.1875 * 0.01);
  EXPECT_NEAR(solved.mean_radiosity(grids[1], 1).x / pi, 0.7 * 2.1875, 0.7 * 2.1875 * 0.01);
}

std::string shining_room(double albedo) {
  return test::view_text() +
         fmt::format("materials: {{wall: {{luminaire: {{color: {}, emission: 1}}}}}}\nscene:\n", albedo) +
         room("wall");
}

TEST(Radiosity, FurnaceHasTheSameLightEverywhere) {
  // Closed, one exitance E = π and one albedo ρ: B = E / (1 - ρ), of which E is emitted.
  for (const FormFactors kind : {FormFactors::rays, FormFactors::hemicube}) {
    RenderSettings settings = matrix_settings(1, 3'000);
    settings.zones.form_factors = kind;
    settings.zones.hemicube_cells = 8;
    settings.zones.primary = ZonePrimary::shot;
    SolvedZones solved(shining_room(0.5), settings);
    for (const ZoneGrid& grid : solved.zones.map().grids())
      for (uint32_t cell = 0; cell < 4; ++cell) {
        EXPECT_NEAR(solved.radiosity(grid, cell).x / pi, 1, 0.005);
        EXPECT_EQ(solved.radiosity(grid, cell, 1), Color(0));  // outside nothing shines
      }
    EXPECT_TRUE(solved.solution.escaped.is_zero());
  }
}

TEST(Radiosity, CubeWithAZonePerFace) {
  // Equation 2.6 of six faces, E = 1 of the top and ρ = 0.7, solved by hand with F of opposite faces 0.199825
  // and of those with a common edge 0.200044. Of the top 1 is emitted.
  RenderSettings settings = matrix_settings(3, 600'000);
  settings.zones.primary = ZonePrimary::shot;
  SolvedZones solved(test::shining_cube(), settings);
  const auto grids = solved.zones.map().grids();
  ASSERT_EQ(grids.size(), 6u);
  for (size_t i = 0; i < 6; ++i)
    EXPECT_NEAR(solved.radiosity(grids[i]).x, test::kOfShiningCube[i], 0.004) << i;
}

TEST(Radiosity, AgreesWithProgressiveRefinement) {
  // The matrix, all zones at a time and one at a time, each five times: means in three sigma of each other.
  const std::string text =
      test::view_text() +
      "lights: [{position: [0.5, 0.8, 0.4], color: 1}]\nmaterials: {wall: {lambertian: [0.8, 0.5, 0.4]}}\n"
      "scene:\n" +
      room("wall");
  struct Mean {
    double value = 0, error2 = 0;
  };
  const auto mean_of = [&](LightingModel model, ZoneShooting shooting) {
    std::vector<double> values;
    for (uint64_t seed = 1; seed <= 5; ++seed) {
      RenderSettings settings = matrix_settings(1, 12'000);
      settings.lighting = model;
      settings.seed = seed;
      settings.zones.samples = 64;
      settings.zones.shooting = shooting;
      SolvedZones solved(text, settings);
      const ZoneGrid& floor = solved.zones.map().grids()[0];
      Power indirect;
      for (uint32_t cell = 0; cell < floor.cell_count; ++cell) {
        indirect += solved.solution.total[floor.slot(cell, 0)];
        indirect -= solved.solution.direct[floor.slot(cell, 0)];
      }
      values.push_back(solved.solution.quantum.value(indirect).x);
    }
    Mean mean;
    for (const double v : values) mean.value += v / 5;
    for (const double v : values) mean.error2 += (v - mean.value) * (v - mean.value) / (5 * 4);
    return mean;
  };
  const Mean matrix = mean_of(LightingModel::radiosity, ZoneShooting::all);
  for (const ZoneShooting shooting : {ZoneShooting::all, ZoneShooting::one}) {
    const Mean other = mean_of(LightingModel::zonal, shooting);
    const double rounds = 1e-3 * other.value;  // what is left unsent
    EXPECT_NEAR(matrix.value, other.value, 3 * std::sqrt(matrix.error2 + other.error2) + rounds);
    EXPECT_LT(std::sqrt(matrix.error2 + other.error2), 0.02 * matrix.value);
  }
}

TEST(Radiosity, CutOrderAndNodesDoNotShow) {
  const CompiledScene compiled = compile(test::load_yaml(test::view_text() + kMixedRoom + room("wall")));
  for (const FormFactors kind : {FormFactors::rays, FormFactors::hemicube}) {
    RenderSettings settings = matrix_settings(0.7, 3'000);
    settings.zones.samples = 4;
    settings.zones.form_factors = kind;
    settings.zones.hemicube_cells = 7;
    const std::vector<std::byte> alone = test::solve_zones(compiled.scene, settings);
    settings.zones.batch = 7;
    EXPECT_EQ(test::solve_zones(compiled.scene, settings, 3, 5), alone);
    settings.zones.batch = 1000;
    EXPECT_EQ(test::solve_zones(compiled.scene, settings, 2, 9), alone);
  }
}

TEST(Radiosity, AMatrixBeyondMemoryIsRefused) {
  RenderSettings settings = matrix_settings(0.01, 1);
  settings.zones.most_GiB = 0.1;
  const CompiledScene compiled = compile(test::load_yaml(shining_room(0.5)));
  try {
    make_zone_solver(compiled.scene, settings, 0);
    FAIL();
  } catch (const std::runtime_error& e) {
    EXPECT_NE(std::string(e.what()).find("--zone-size"), std::string::npos) << e.what();
  }
}

TEST(Radiosity, DamagedRowsAreRefused) {
  const CompiledScene compiled = compile(test::load_yaml(shining_room(0.5)));
  const RenderSettings settings = matrix_settings(3, 600);
  const auto solver = make_zone_solver(compiled.scene, settings, 0);
  const auto tracer = make_zone_tracer(compiled.scene, settings, 0);
  const auto stage = solver->next_stage();
  tracer->begin(stage->data);
  const std::vector<std::byte> whole =
      tracer->work(0, std::min(stage->units, stage->units_per_item), [] {}).bytes;
  for (size_t i = 0; i < whole.size(); ++i)
    EXPECT_THROW(solver->add(0, std::span(whole).first(i)), std::runtime_error);
  std::vector<std::byte> more = whole;
  more.push_back(std::byte{0});
  EXPECT_THROW(solver->add(0, more), std::runtime_error);
  EXPECT_NO_THROW(solver->add(0, whole));
}

}  // namespace
}  // namespace rayfarm
