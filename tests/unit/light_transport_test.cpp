// The lighting models against answers that can be worked out by hand, and against each other.
#include <cstring>

#include "common/lighting/renderer.h"
#include "common/lighting/torrance_sparrow.h"
#include "tests/unit/probe.h"

namespace rayfarm {
namespace {

void expect_color(const Color& a, const Color& b, double tolerance) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance) << "channel " << c;
}

/// A closed room of six squares that face inward, side 2, about the origin.
std::string room(const std::string& material) {
  std::string text;
  for (const char* points :
       {"[-1,-1,-1],[-1,-1,1],[1,-1,1],[1,-1,-1]", "[-1,1,-1],[1,1,-1],[1,1,1],[-1,1,1]",
        "[-1,-1,-1],[1,-1,-1],[1,1,-1],[-1,1,-1]", "[-1,-1,1],[-1,1,1],[1,1,1],[1,-1,1]",
        "[-1,-1,-1],[-1,1,-1],[-1,1,1],[-1,-1,1]", "[1,-1,-1],[1,-1,1],[1,1,1],[1,1,-1]"})
    text += fmt::format("  - {{material: {}, polygon: {{points: [{}]}}}}\n", material, points);
  return text;
}

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

const char* const kMixedRoom = R"(
ambient: [0.5, 0.6, 0.7]
background: [0.1, 0.2, 0.3]
lights: [{position: [0.5, 0.8, 0.4], color: [0.9, 0.8, 0.7]}]
materials:
  wall: {color: [0.8, 0.5, 0.4], ambient: 0.7, diffuse: 0.7}
  mirror: {color: 0.9, ambient: 0.2, diffuse: 0.2, specular: 0.5, shininess: 20, reflect: 0.6}
  glass: {color: 0.9, ambient: 0.1, diffuse: 0.1, transmit: 0.8, index: 1.5}
scene:
  - {material: mirror, sphere: {center: [-0.4, -0.5, -0.3], radius: 0.4}}
  - {material: glass, sphere: {center: [0.4, -0.5, 0.2], radius: 0.4}}
)";

TEST(Thesis, ReducesToWhittedAndPhong) {
  // With diffuse rays so weak that ambient light stands in for all of them, Equation 3.3 is 3.4: Whitted's
  // model with an ambient coefficient that equals the diffuse one.
  Probe probe(kMixedRoom + room("wall"));
  probe.settings.max_depth = 5;
  for (int i = 0; i < 40; ++i) {
    const Vec3 direction(std::sin(1.0 * i), std::cos(1.7 * i), std::sin(2.3 * i + 1));
    probe.settings.lighting = LightingModel::whitted;
    const Color whitted = probe.mean(Vec3(0, 0.3, 0.6), direction, 1);
    probe.settings.lighting = LightingModel::thesis;
    probe.settings.diffuse_rays = 7;
    probe.settings.diffuse_reach = 1e-200;
    expect_color(probe.mean(Vec3(0, 0.3, 0.6), direction, 1), whitted, 1e-9);
    // Of depth 2 the lighting tree is flat, and Whitted's model is Phong's.
    probe.settings.lighting = LightingModel::phong;
    const Color phong = probe.mean(Vec3(0, 0.3, 0.6), direction, 1);
    probe.settings.lighting = LightingModel::whitted;
    probe.settings.max_depth = 1;
    expect_color(probe.mean(Vec3(0, 0.3, 0.6), direction, 1), phong, 1e-12);
    probe.settings.max_depth = 5;
  }
}

TEST(Thesis, ConvergesToPathsWhereSurfacesAreDiffuse) {
  Probe probe(R"(
lights: [{position: [0.3, 0.5, 0.2], color: 0.8}]
materials: {wall: {lambertian: [0.5, 0.3, 0.2]}}
scene:
)" + room("wall"));
  const Vec3 origin(0, 0.1, 0.3), direction(0.2, -1, 0.1);
  const Color path = probe.mean(origin, direction, 1 << 15);
  probe.settings.lighting = LightingModel::thesis;
  probe.settings.max_depth = 12;
  expect_color(probe.mean(origin, direction, 1 << 13), path, 0.004);
}

TEST(Thesis, ConvergesToPathsInGoralsRoom) {
  // With all its rays, untrimmed and deep, the model is the rendering equation for diffuse surfaces. What the
  // plates leave out is what trimming takes away: light that was scattered more than once on its way.
  const CompiledScene compiled = compile(load_scene(std::string(RAYFARM_SOURCE) + "/scenes/goral_room.yaml"));
  RenderSettings settings;
  settings.width_px = settings.height_px = 32;
  settings.crop = {0, 0, 32, 32};
  settings.samples = 256;
  settings.max_depth = 16;
  settings.pixel_format = PixelFormat::float32;
  const auto blocks = [&] {  // means of 8 × 8 pixels
    const RenderedPixels rendered = Renderer(compiled.scene, settings).render(0, settings.crop, [] {});
    std::array<Color, 16> means{};
    for (size_t i = 0; i < 32 * 32; ++i) {
      std::array<float, 3> pixel;
      std::memcpy(pixel.data(), rendered.pixels.data() + 12 * i, 12);
      means[i / 256 * 4 + i % 32 / 8] += Color(pixel[0], pixel[1], pixel[2]) / 64.0;
    }
    return means;
  };
  settings.lighting = LightingModel::path;
  const auto path = blocks();
  settings.lighting = LightingModel::thesis;
  settings.min_weight = 0;
  const auto gathered = blocks();
  settings.min_weight = 0.41;  // as the plates are trimmed
  const auto trimmed = blocks();
  double lost = 0;
  for (size_t i = 0; i < 16; ++i) {
    expect_color(gathered[i], path[i], 0.005);
    lost += (path[i].x - trimmed[i].x) / 16;
  }
  EXPECT_GT(lost, 0.05);
}

TEST(Thesis, CountsEachSourceOnce) {
  // A luminous ceiling is a primary source: shadow rays find it, diffuse rays must not find it again.
  Probe probe(R"(
materials: {m: {lambertian: 1}, lamp: {luminaire: {emission: 1}}}
scene:
  - {material: m, polygon: {points: [[-9,0,-9],[-9,0,9],[9,0,9],[9,0,-9]]}}
  - {material: lamp, polygon: {points: [[-2,1,-2],[2,1,-2],[2,1,2],[-2,1,2]]}}
)");
  const Color path = probe.mean(Vec3(1, 0.5, 0), Vec3(-1, -0.5, 0), 1 << 14);
  probe.settings.lighting = LightingModel::thesis;
  probe.settings.max_depth = 2;
  expect_color(probe.mean(Vec3(1, 0.5, 0), Vec3(-1, -0.5, 0), 1 << 14), path, 0.005);
}

TEST(Thesis, DiffuseDirectionsShareTheLightEvenly) {
  for (const uint32_t rays : {1u, 2u, 7u, 25u, 100u, 1000u}) {
    const DiffuseDirections directions(rays);
    ASSERT_EQ(directions.about_y().size(), rays);
    Vec3 sum(0);
    for (const Vec3& d : directions.about_y()) {
      EXPECT_NEAR(glm::length(d), 1, 1e-12);
      EXPECT_GE(d.y, 0);
      sum += d;
    }
    // Equal weights under cos θ / π: the mean direction is (0, 2/3, 0).
    if (rays >= 25) {
      EXPECT_NEAR(sum.y / rays, 2.0 / 3, 0.02);
    }
    if (rays >= 7) {
      EXPECT_NEAR(std::hypot(sum.x, sum.z) / rays, 0, 0.03);
    }
  }
  // 25 rays: one along the normal and four bands of six (Figure 3.1).
  const DiffuseDirections figure(25);
  EXPECT_EQ(figure.about_y()[0], Vec3(0, 1, 0));
  for (size_t band = 0; band < 4; ++band)
    for (size_t i = 1; i < 6; ++i)
      EXPECT_NEAR(figure.about_y()[1 + 6 * band + i].y, figure.about_y()[1 + 6 * band].y, 1e-12);
}

TEST(Thesis, OneRayServesTheReflectedAndTheDiffuseTerm) {
  // A glossy floor in a room with a luminous ceiling. Of 64 diffuse rays one lies where the mirror shows; the
  // sum stays what Equation 3.6a gives for both terms.
  Probe probe(R"(
lights: [{position: [0.3, 0.5, 0.2], color: 0.8}]
materials:
  wall: {lambertian: [0.5, 0.3, 0.2]}
  floor: {color: 0.8, ambient: 0, diffuse: 0.5, reflect: 0.4}
  lamp: {luminaire: {emission: 2}}
scene:
  - {material: floor, polygon: {points: [[-1, -0.9, -1], [-1, -0.9, 1], [1, -0.9, 1], [1, -0.9, -1]]}}
  - {material: lamp, polygon: {points: [[-0.4, 0.9, -0.4], [0.4, 0.9, -0.4], [0.4, 0.9, 0.4], [-0.4, 0.9, 0.4]]}}
)" + room("wall"));
  const Vec3 origin(0, 0.1, 0.3), direction(0.1, -1, -0.1);  // it sees the lamp in the floor
  const Color path = probe.mean(origin, direction, 1 << 15);
  probe.settings.lighting = LightingModel::thesis;
  probe.settings.max_depth = 8;
  probe.settings.diffuse_rays = 1;
  probe.counts = {};
  const Color gathered = probe.mean(origin, direction, 1 << 13);
  expect_color(gathered, path, 0.02);
  EXPECT_GT(gathered.x, 0.8);  // 0.4 of the lamp's 2, and more
  probe.settings.max_depth = 2;
  probe.settings.diffuse_rays = 64;
  probe.counts = {};
  probe.mean(origin, direction, 1);
  EXPECT_EQ(probe.counts[RayKind::reflected], 1u);
  EXPECT_EQ(probe.counts[RayKind::diffuse], 63u);
}

TEST(Thesis, MoreRaysWhereNeighborsDiffer) {
  Probe probe(R"(
lights: [{position: [0.3, 0.5, 0.2], color: 0.8}]
materials: {wall: {lambertian: 0.5}, dark: {lambertian: 0}}
scene:
  - {material: dark, sphere: {center: [0.4, -0.6, 0], radius: 0.3}}
)" + room("wall"));
  probe.settings.lighting = LightingModel::thesis;
  probe.settings.max_depth = 2;
  probe.settings.diffuse_rays = 25;
  const Color few = probe.mean(Vec3(0, 0.1, 0), Vec3(0, -1, 0), 1);
  EXPECT_EQ(probe.counts[RayKind::diffuse], 25u);
  probe.counts = {};
  probe.settings.diffuse_contrast = 0.002;
  const Color more = probe.mean(Vec3(0, 0.1, 0), Vec3(0, -1, 0), 1);
  EXPECT_GT(probe.counts[RayKind::diffuse], 25u);
  EXPECT_LT(probe.counts[RayKind::diffuse], 50u);
  EXPECT_NE(few, more);
  probe.settings.diffuse_rays = 10000;
  probe.settings.diffuse_contrast = 0;
  const Color true_color = probe.mean(Vec3(0, 0.1, 0), Vec3(0, -1, 0), 1);
  expect_color(more, true_color, 0.03);
}

TEST(TorranceSparrow, FacetsHaveTheirShape) {
  EXPECT_EQ(facet_distribution(1, 20), 1);
  EXPECT_NEAR(facet_distribution(std::pow(0.5, 1 / 20.0), 20), 0.5, 1e-9);  // where cos²⁰ is a half
  EXPECT_EQ(facet_visibility(1, 1, 1, 1), 1);
  EXPECT_NEAR(facet_visibility(0.5, 0.2, 0.6, 0.5), 0.4, 1e-12);  // 2 (N·H)(N·L) / (V·H): shadowed
  // Light, normal and viewer in one line: K_S D G F / (N·E) = K_S.
  Material m;
  m.specular = 0.7;
  const Vec3 n(0, 0, 1);
  expect_color(facet_highlight(m, n, n, n), Color(0.7), 1e-12);
  // Off-specular peak: at a grazing view the highlight is brighter than at the same angle from the normal.
  m.index = 1.5;
  const auto at = [](double degrees) {
    return Vec3(std::sin(degrees * M_PI / 180), 0, std::cos(degrees * M_PI / 180));
  };
  EXPECT_GT(facet_highlight(m, n, at(-75), at(75)).x, 3 * facet_highlight(m, n, at(-30), at(30)).x);
  EXPECT_EQ(facet_highlight(m, n, Vec3(0, 0, -1), n), Color(0));
}

TEST(Classical, LuminairesLightWhittedSurfacesToo) {
  // The mean over many samples of the penumbra equals what paths find, where there is no second bounce.
  Probe probe(R"(
ambient: 0
materials: {m: {color: 1, ambient: 0, diffuse: 0.9}, dark: {lambertian: 0}, lamp: {luminaire: {emission: 3}}}
scene:
  - {material: m, polygon: {points: [[-9,0,-9],[-9,0,9],[9,0,9],[9,0,-9]]}}
  - {material: dark, sphere: {center: [0.3, 0.5, 0], radius: 0.2}}
  - {material: lamp, polygon: {points: [[-0.5,1,-0.5],[0.5,1,-0.5],[0.5,1,0.5],[-0.5,1,0.5]]}}
)");
  const Vec3 origin(0, 0.4, 0.8), direction(0.1, -0.4, -0.7);
  const Color path = probe.mean(origin, direction, 1 << 14);
  probe.settings.lighting = LightingModel::whitted;
  probe.settings.max_depth = 5;
  const Color whitted = probe.mean(origin, direction, 1 << 14);
  expect_color(whitted, path, 0.01);
  EXPECT_GT(whitted.x, 0.05);
}

TEST(Lighting, SamplesDoNotDependOnTheirPacket) {
  Probe probe(kMixedRoom + room("wall"));
  for (const LightingModel model : {LightingModel::path, LightingModel::thesis}) {
    probe.settings.lighting = model;
    probe.settings.max_depth = 5;
    probe.settings.samples = 8;
    const SamplingTables tables(probe.settings, 0);
    const FrameContext context{probe.compiled.scene, probe.pose, tables};
    std::vector<Ray> rays;
    std::vector<SampleId> ids;
    for (uint32_t i = 0; i < 8; ++i) {
      rays.push_back({Vec3(0, 0.3, 0.6), normalized(Vec3(0.1 * i, -0.5, -1))});
      ids.push_back({static_cast<int>(i), 2, i});
    }
    std::array<Color, 8> together, alone;
    make_integrator(model)->trace(context, rays, ids, probe.counts, together.data());
    for (size_t i = 0; i < 8; ++i)
      make_integrator(model)->trace(context, std::span(rays).subspan(i, 1), std::span(ids).subspan(i, 1),
                                    probe.counts, &alone[i]);
    EXPECT_EQ(together, alone);
  }
}

}  // namespace
}  // namespace rayfarm
