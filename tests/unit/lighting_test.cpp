// Analytic answers of the classical models: what Equations 2.4 and 2.12 give where they can be worked out by
// hand.
#include "common/lighting/torrance_sparrow.h"
#include "tests/unit/probe.h"

namespace rayfarm {
namespace {

struct World {
  explicit World(const std::string& text)
      : compiled(compile(test::load_yaml(text))), frame_pose(compiled.scene), pose(frame_pose.at(0)) {}
  Color trace(const Vec3& origin, const Vec3& direction) {
    const Ray ray{origin, normalized(direction)};
    const SampleId id;
    Color color;
    make_integrator(settings.lighting)
        ->trace({compiled.scene, pose, SamplingTables(settings, 0)}, RayPacket(std::span(&ray, 1)),
                std::span(&id, 1), counts, &color);
    return color;
  }
  CompiledScene compiled;
  FrameState frame_pose;
  Pose pose;
  RenderSettings settings;
  RayCounts counts;
};

TEST(Lighting, PhongTermsOnAPlane) {
  // Light at 45° over the point, viewer straight above: I = C (ka Ia + kd I cos 45°) + ks I cos(45°)^n.
  World world(test::view_text() + R"(
ambient: 0.5
lights: [{position: [3, 3, 0], color: [0.9, 0.8, 0.7]}]
materials: {m: {color: [1, 0.5, 0.25], ambient: 0.2, diffuse: 0.6, specular: 0.3, shininess: 4}}
scene: [{material: m, polygon: {points: [[-9, 0, 9], [9, 0, 9], [9, 0, -9], [-9, 0, -9]]}}]
)");
  const double c = std::sqrt(0.5);
  const Color light(0.9, 0.8, 0.7),
      expected = Color(1, 0.5, 0.25) * (Color(0.1) + 0.6 * c * light) + 0.3 * 0.25 * light;
  expect_color(world.trace(Vec3(0, 5, 0), Vec3(0, -1, 0)), expected);
  expect_color(world.trace(Vec3(0, -5, 0), Vec3(0, 1, 0)), Color(1, 0.5, 0.25) * 0.1);  // the unlit side
}

TEST(Lighting, ShadowsBlockFully) {
  World world(test::view_text() + R"(
ambient: 0
lights: [{position: [0, 10, 0]}]
scene:
  - {polygon: {points: [[-9, 0, 9], [9, 0, 9], [9, 0, -9], [-9, 0, -9]]}}
  - {sphere: {center: [0, 5, 0], radius: 1}}
)");
  expect_color(world.trace(Vec3(0.5, 2, 0), Vec3(0, -1, 0)), Color(0));
  EXPECT_GT(world.trace(Vec3(8, 2, 0), Vec3(0, -1, 0)).x, 0.1);
}

const std::string kFacingMirrors = test::view_text() + R"(
background: 0
materials: {m: {ambient: 1, diffuse: 0, reflect: 0.5}}
scene:
  - {material: m, polygon: {points: [[-9, 0, 9], [9, 0, 9], [9, 0, -9], [-9, 0, -9]]}}
  - {material: m, polygon: {points: [[-9, 2, 9], [9, 2, 9], [9, 2, -9], [-9, 2, -9]]}}
)";

TEST(Lighting, MirrorsHaveTheirDepthAndWeightLimits) {
  // Two facing mirrors of .5 with ambient 1: at depth d the sum of 1 + 1/2 + … has d terms.
  World world(kFacingMirrors);
  for (uint32_t depth = 1; depth <= 6; ++depth) {
    limit_by_depth(world.settings, depth);
    expect_color(world.trace(Vec3(0, 1, 0), Vec3(0, -1, 0)), Color(2 - std::pow(0.5, depth - 1)));
  }
  limit_by_depth(world.settings, 50);
  world.settings.min_weight = 0.2;  // .5 and .25 pass, .125 does not: three terms
  expect_color(world.trace(Vec3(0, 1, 0), Vec3(0, -1, 0)), Color(1.75));
  world.settings.lighting = LightingModel::phong;
  expect_color(world.trace(Vec3(0, 1, 0), Vec3(0, -1, 0)), Color(1));
}

TEST(Lighting, FacingMirrorsShowAsManyImagesAsReflectionsAreAllowed) {
  // Thesis 2.3.4: "after about four or five reflections … there is little more additional information". Two
  // facing mirrors of .5 with ambient 1: with k reflections the sum of 1 + 1/2 + … has k + 1 terms.
  // Transmitted rays have a limit of their own.
  World world(kFacingMirrors);
  const auto images = [&world] { return world.trace(Vec3(0, 1, 0), Vec3(0, -1, 0)); };
  expect_color(images(), Color(2 - std::pow(0.5, 4)));  // the default
  world.settings.max_transmissions = 0;
  for (uint32_t reflections = 0; reflections <= 6; ++reflections) {
    world.settings.max_reflections = reflections;
    expect_color(images(), Color(2 - std::pow(0.5, reflections)));
  }
}

TEST(Lighting, LightPassesAsManySurfacesAsTransmissionsAreAllowed) {
  // Thesis 2.3.4: "after … about seven transparent objects there is little more additional information to be
  // obtained". Behind n panes that transmit .8 the background shows with .8^n, up to the limit. Paths that
  // lose light end by chance, so theirs lose none.
  for (const LightingModel model : {LightingModel::whitted, LightingModel::thesis, LightingModel::path}) {
    const double transmit = model == LightingModel::path ? 1 : 0.8;
    for (uint32_t n = 0; n <= 9; ++n) {
      std::string text =
          test::view_text() +
          fmt::format(
              "background: [0.25, 0.5, 1]\nmaterials: {{pane: {{ambient: 0, diffuse: 0, transmit: {}}}}}\n",
              transmit) +
          "scene:\n  - {sphere: {center: [50, 0, 0], radius: 1}}\n";
      for (uint32_t i = 0; i < n; ++i)
        text += fmt::format(
            "  - {{material: pane, polygon: {{points: [[-9,{0},9],[9,{0},9],[9,{0},-9],[-9,{0},-9]]}}}}\n",
            -static_cast<int>(i));
      World world(text);
      world.settings.lighting = model;
      world.settings.max_reflections = 0;
      const auto behind = [&world] { return world.trace(Vec3(0, 1, 0), Vec3(0.1, -1, 0)); };
      const Color seen = std::pow(transmit, n) * Color(0.25, 0.5, 1);
      expect_color(behind(), n <= 7 ? seen : Color(0));  // the default
      world.settings.max_transmissions = 3;
      expect_color(behind(), n <= 3 ? seen : Color(0));
    }
  }
}

TEST(Lighting, WhereLightIsOnlyReflectedALimitOfReflectionsIsADepth) {
  // Mirrored and diffuse rays alike: k of them are a tree of depth k + 1, to the bit.
  Probe probe(R"(
lights: [{position: [0.5, 0.8, 0.4]}]
materials:
  wall: {color: [0.8, 0.5, 0.4], ambient: 0.2, diffuse: 0.6, reflect: 0.3}
  lamp: {luminaire: {emission: 2}}
scene:
  - {material: lamp, sphere: {center: [0.2, 0.3, 0.1], radius: 0.1}}
)" + room("wall"));
  for (const LightingModel model : {LightingModel::whitted, LightingModel::thesis, LightingModel::path}) {
    probe.settings.lighting = model;
    double brightest = -1;
    for (uint32_t reflections = 0; reflections <= 4; ++reflections) {
      limit_by_depth(probe.settings, reflections + 1);
      const Color by_depth = probe.mean(Vec3(-0.5, 0.1, 0.6), Vec3(0.3, -0.5, -1), 32);
      limit_by_depth(probe.settings, 12);
      probe.settings.max_reflections = reflections;
      EXPECT_EQ(probe.mean(Vec3(-0.5, 0.1, 0.6), Vec3(0.3, -0.5, -1), 32), by_depth);
      EXPECT_GT(by_depth.x, brightest);
      brightest = by_depth.x;
    }
  }
}

TEST(Lighting, RefractionFollowsSnell) {
  // Through a slab of index 1.5 a ray leaves parallel, shifted; it meets a wall whose colour tells where.
  const double angle = M_PI / 3;  // in air; inside asin(sin 60° / 1.5)
  const double inside = std::asin(std::sin(angle) / 1.5);
  const double x =
      std::tan(angle) + std::tan(inside) + std::tan(angle);  // one unit above, in, and below the slab
  for (const double offset : {-1e-6, 1e-6}) {
    std::string text = test::view_text() + R"(
background: 0
materials:
  glass: {ambient: 0, diffuse: 0, transmit: 1, index: 1.5}
  wall: {ambient: 1, diffuse: 0}
scene:
  - {material: glass, box: {min: [-50, 0, -50], max: [50, 1, 50]}}
  - {material: wall, polygon: {points: [[EDGE, -1, -9], [EDGE, -1, 9], [99, -1, 9], [99, -1, -9]]}}
)";
    const std::string edge = fmt::format("{:.15f}", x + offset);
    for (size_t at; (at = text.find("EDGE")) != std::string::npos;) text.replace(at, 4, edge);
    World edged(text);
    expect_color(edged.trace(Vec3(0, 2, 0), Vec3(std::sin(angle), -std::cos(angle), 0)),
                 Color(offset < 0 ? 1 : 0));
  }
}

TEST(Lighting, TotalInternalReflectionTakesTheTransmittedShare) {
  // From inside glass at 60° (critical angle 41.8°) to a face: all of T goes along the mirror direction.
  World world(test::view_text() + R"(
background: [0.25, 0.5, 1]
materials: {glass: {ambient: 0, diffuse: 0, transmit: 0.9, index: 1.5}}
scene: [{material: glass, polygon: {points: [[-9, 0, 9], [9, 0, 9], [9, 0, -9], [-9, 0, -9]]}}]
)");
  expect_color(world.trace(Vec3(0, -1, 0), Vec3(std::sin(M_PI / 3), std::cos(M_PI / 3), 0)),
               0.9 * Color(0.25, 0.5, 1));
  EXPECT_EQ(world.counts[RayKind::transmitted], 0u);
  EXPECT_EQ(world.counts[RayKind::reflected], 1u);
  world.settings.max_transmissions = 0;  // it is a reflection
  expect_color(world.trace(Vec3(0, -1, 0), Vec3(std::sin(M_PI / 3), std::cos(M_PI / 3), 0)),
               0.9 * Color(0.25, 0.5, 1));
  world.settings.max_reflections = 0;
  expect_color(world.trace(Vec3(0, -1, 0), Vec3(std::sin(M_PI / 3), std::cos(M_PI / 3), 0)), Color(0));
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
  std::string text = kMixedRoom + room("wall");
  text.replace(text.find("reflect: 0.6"), 12, "reflect: 0.6, exponent: 30");
  Probe probe(text);
  probe.settings.reflected_rays = 11;
  for (const LightingModel model : {LightingModel::path, LightingModel::thesis, LightingModel::whitted}) {
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
    make_integrator(model)->trace(context, RayPacket(rays), ids, probe.counts, together.data());
    for (size_t i = 0; i < 8; ++i)
      make_integrator(model)->trace(context, RayPacket(std::span(rays).subspan(i, 1)),
                                    std::span(ids).subspan(i, 1), probe.counts, &alone[i]);
    EXPECT_EQ(together, alone);
  }
}

}  // namespace
}  // namespace rayfarm
