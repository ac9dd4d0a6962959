// Paths against answers that can be worked out by hand.
#include "tests/unit/probe.h"

namespace rayfarm {
namespace {

TEST(Path, FurnaceRadianceIsEmissionOverOneMinusAlbedo) {
  // Every point of a closed body emits E and reflects the share a of what it receives: L = E + a L.
  Probe probe("materials: {m: {luminaire: {color: [0.2, 0.5, 0.8], emission: [1, 2, 0.5]}}}\nscene:\n" +
              room("m"));
  const Color found = probe.mean(Vec3(0.1, 0.2, 0), Vec3(0.3, 1, 0.2), 1 << 18);
  expect_color(found / Color(1.25, 4, 2.5), Color(1), 0.001);
}

TEST(Path, FurnaceWithGlassMetalAndPolishInIt) {
  // What neither emits nor absorbs can't be seen in light that is the same everywhere.
  Probe probe(R"(
background: 1
materials:
  glass: {dielectric: {index: 1.5}}
  paint: {polished: {color: 1, index: 1.5}}
  white: {lambertian: 1}
  sheet: {translucent: {front: 0.6, back: 0.6, through: 0.4}}
scene:
  - {material: glass, sphere: {center: [0, 0, 0], radius: 1}}
  - {material: paint, sphere: {center: [3, 0, 0], radius: 1}}
  - {material: white, sphere: {center: [6, 0, 0], radius: 1}}
  - {material: sheet, sphere: {center: [9, 0, 0], radius: 1}}
)");
  for (const double x : {0.4, 3.4, 6.4, 9.4})
    expect_color(probe.mean(Vec3(x, 0.3, 5), Vec3(0, 0, -1), 1 << 15), Color(1), 0.005);
}

/// Light from a square of radiance 1 on a white surface is π × the form factor × albedo / π.
double form_factor(const std::string& square, uint32_t samples) {
  Probe probe(R"(
materials: {m: {lambertian: 1}, lamp: {luminaire: {emission: 1}}}
scene:
  - {material: m, polygon: {points: [[-0.001,0,-0.001],[-0.001,0,0.001],[0.001,0,0.001],[0.001,0,-0.001]]}}
  - {material: lamp, polygon: {points: )" +
              square + "}}\n");
  return probe.mean(Vec3(0.3, 0.4, 0.1), Vec3(-0.3, -0.4, -0.1), samples).x;
}

TEST(Path, FormFactorsOfSquares) {
  // A point to a parallel rectangle a × b over its corner at height c (Siegel and Howell, configuration 13):
  // (1 / 2π) (A / √(1 + A²) atan(B / √(1 + A²)) + B / √(1 + B²) atan(A / √(1 + B²))), A = a / c, B = b / c.
  const auto parallel = [](double a, double b) {
    const double p = std::sqrt(1 + a * a), q = std::sqrt(1 + b * b);
    return (a / p * std::atan(b / p) + b / q * std::atan(a / q)) / (2 * M_PI);
  };
  EXPECT_NEAR(form_factor("[[-1,1,-1],[1,1,-1],[1,1,1],[-1,1,1]]", 1 << 15) / (4 * parallel(1, 1)), 1, 0.002);
  EXPECT_NEAR(form_factor("[[0,0.5,0],[1,0.5,0],[1,0.5,2],[0,0.5,2]]", 1 << 15) / parallel(2, 4), 1, 0.002);
  // A perpendicular rectangle of height a and width b that stands at distance c, its lower corner before the
  // point: (1 / 2π) (atan(b / c) - c / √(a² + c²) atan(b / √(a² + c²))).
  const double a = 1, b = 1, c = 1, r = std::sqrt(a * a + c * c);
  const double expected = (std::atan(b / c) - c / r * std::atan(b / r)) / (2 * M_PI);
  EXPECT_NEAR(form_factor("[[1,0,0],[1,0,1],[1,1,1],[1,1,0]]", 1 << 16) / expected, 1, 0.002);
}

TEST(Path, SphereLightHasItsIrradiance) {
  // A sphere of radiance L at distance d straight above: E = π L (r / d)², so a white surface shows L (r /
  // d)². As it is, and moved and scaled into place, where it is sampled by area.
  for (const char* lamp :
       {"sphere: {center: [0, 3, 0], radius: 1}",
        "transform: [{scale: 0.5}, {translate: [0, 3, 0]}], sphere: {center: [0, 0, 0], radius: 2}"}) {
    Probe probe(fmt::format(R"(
materials: {{m: {{lambertian: 1}}, lamp: {{luminaire: {{emission: 9}}}}}}
scene:
  - {{material: m, polygon: {{points: [[-1,0,-1],[-1,0,1],[1,0,1],[1,0,-1]]}}}}
  - {{material: lamp, {}}}
)",
                            lamp));
    EXPECT_NEAR(probe.mean(Vec3(1, 1, 0), Vec3(-1, -1, 0), 1 << 14).x, 1, 0.005);
  }
}

TEST(Path, PointSpotAndDistantLights) {
  const auto lit = [](const std::string& light) {
    Probe probe("lights: [" + light + "]\n" + R"(
materials: {m: {lambertian: 0.5}}
scene: [{material: m, polygon: {points: [[-9,0,-9],[-9,0,9],[9,0,9],[9,0,-9]]}}]
)");
    return probe.mean(Vec3(1, 1, 0), Vec3(-1, -1, 0), 8).x;
  };
  EXPECT_NEAR(lit("{position: [0, 2, 0]}"), 0.5, 1e-9);                   // without falloff
  EXPECT_NEAR(lit("{position: [2, 2, 0]}"), 0.5 * std::sqrt(0.5), 1e-9);  // Lambert
  EXPECT_NEAR(lit("{position: [0, 2, 0], falloff: true, intensity: 12}"), 0.5 * 3 / M_PI, 1e-9);
  EXPECT_NEAR(lit("{direction: [0, -1, 0]}"), 0.5, 1e-9);
  EXPECT_NEAR(lit("{position: [0, 2, 0], direction: [0, -1, 0], angle: 20, intensity: 12}"), 0.5 * 3 / M_PI,
              1e-9);
  EXPECT_EQ(lit("{position: [2, 2, 0], direction: [0, -1, 0], angle: 20, intensity: 12}"), 0);
  const double half =
      lit("{position: [0, 2, 0], direction: [0.5773502691896258, -1, 0], angle: 10, dark_angle: 60, "
          "intensity: 12}");
  EXPECT_GT(half, 0);
  EXPECT_LT(half, 0.5 * 3 / M_PI);
}

TEST(Path, PhotometricFilesShapeTheLight) {
  // 90 candela straight down, 30 at 45°, nothing from 90° on; twice as much along y as along x.
  const auto file = [](const char* name, const char* angles) {
    return test::write_temporary(
        name, std::string("IESNA:LM-63-1995\n[TEST] made\nTILT=NONE\n1 1000 1.0 3 ") + angles);
  };
  file("round.ies", "1 1 2 0 0 0\n1 1 100\n0 45 90\n0\n90 30 0\n");
  file("quadrant.ies", "2 1 2 0 0 0\n1 1 100\n0 45 90\n0 90\n90 30 0\n90 60 0\n");
  file("bad.ies", "1 1 2 0 0 0\n1 1 100\n0 45 40\n0\n90 30 0\n");
  const auto radiance = [](const std::string& ies, double x, double z) {
    Probe probe(fmt::format("lights: [{{position: [0, 2, 0], ies: {}}}]\n", ies) + R"(
materials: {m: {lambertian: 1}}
scene: [{material: m, polygon: {points: [[-9,0,-9],[-9,0,9],[9,0,9],[9,0,-9]]}}]
)");
    return probe.mean(Vec3(x, 1, z), Vec3(0, -1, 0), 8).x;
  };
  // L = I cos θ / (π d²)
  EXPECT_NEAR(radiance("round.ies", 0.001, 0), 90 / (M_PI * 4), 0.02);
  const double at45 = std::sqrt(0.5) / (M_PI * 8);
  EXPECT_NEAR(radiance("round.ies", 2, 0), 30 * at45, 1e-6);
  EXPECT_NEAR(radiance("round.ies", 0, -2), 30 * at45, 1e-6);
  for (const double side : {-2.0, 2.0}) {
    EXPECT_NEAR(radiance("quadrant.ies", side, 0), 30 * at45, 1e-6);
    EXPECT_NEAR(radiance("quadrant.ies", 0, side), 60 * at45, 1e-6);
    EXPECT_NEAR(radiance("quadrant.ies", side * std::sqrt(0.5), std::sqrt(2)), 45 * at45, 1e-6);
  }
  const std::string scene = test::view_text() + "lights: [{position: [0, 2, 0], ies: NAME}]\nscene: []\n";
  const auto error = [&](const std::string& name) {
    std::string text = scene;
    return test::error_of(text.replace(text.find("NAME"), 4, name));
  };
  EXPECT_NE(error("bad.ies").find("bad.ies:6:"), std::string::npos) << error("bad.ies");
  EXPECT_NE(error("none.ies").find("scene.yaml:2:"), std::string::npos) << error("none.ies");
}

TEST(Path, AbsorptionFollowsBeer) {
  // Straight through 2 units of glass that keeps half of the red light a unit: 1/4, times what two faces
  // pass.
  Probe probe(R"(
background: 1
materials: {glass: {dielectric: {index: 1.0001, filter: [0.5, 1, 1]}}}
scene: [{material: glass, box: {min: [-5, -5, -1], max: [5, 5, 1]}}]
)");
  expect_color(probe.mean(Vec3(0.1, 0.2, 4), Vec3(0, 0, -1), 64), Color(0.25, 1, 1), 1e-4);
}

TEST(Path, NestedDielectricsAreOrderedByPriority) {
  // Water reaches into the wall of its glass. With the glass stronger the ray sees air, glass, water: the
  // overlap is glass, and its water face is nothing. Slabs: glass 0 … 1, water 0.5 … 9; straight in, so only
  // reflectances tell: to a black wall inside the water the ray passes the faces (air, glass) and (glass,
  // water).
  const auto passed = [](int glass, int water) {
    Probe probe(fmt::format(R"(
materials:
  glass: {{dielectric: {{index: 1.5, priority: {}}}}}
  water: {{dielectric: {{index: 1.33, priority: {}}}}}
  lamp: {{luminaire: {{emission: 1}}}}
scene:
  - {{material: glass, box: {{min: [-90, -90, -1], max: [90, 90, 0]}}}}
  - {{material: water, box: {{min: [-90, -90, -9], max: [90, 90, -0.5]}}}}
  - {{material: lamp, polygon: {{points: [[-80,-80,-5],[80,-80,-5],[80,80,-5],[-80,80,-5]]}}}}
)",
                            glass, water));
    probe.settings.max_depth = 6;
    return probe.mean(Vec3(0.1, 0.2, 3), Vec3(0, 0, -1), 1 << 14).x;
  };
  const auto through = [](double a, double b) {  // a face's transmittance, with radiance scaled
    const double r = (a - b) / (a + b);
    return (1 - r * r) * (a * a) / (b * b);
  };
  EXPECT_NEAR(passed(2, 1), through(1, 1.5) * through(1.5, 1.33), 0.01);
  // With the water stronger the faces are the same, only half a unit nearer.
  EXPECT_NEAR(passed(1, 2), through(1, 1.5) * through(1.5, 1.33), 0.01);
}

}  // namespace
}  // namespace rayfarm
