// Light that reaches a surface by way of others: lobes of several rays, coloured glass, shadows through
// glass, ambient light, reflections that are turned off.
#include "common/lighting/lobe_rays.h"
#include "tests/unit/probe.h"

namespace rayfarm {
namespace {

/// A square of the xz plane at height y, with the front up.
std::string floor_at(double y, const std::string& material, double half = 9) {
  return fmt::format(
      "  - {{material: {0}, polygon: {{points: "
      "[[-{2},{1},{2}],[{2},{1},{2}],[{2},{1},-{2}],[-{2},{1},-{2}]]}}}}\n",
      material, y, half);
}

const std::vector<LightingModel> kTreeModels{LightingModel::whitted, LightingModel::thesis};

TEST(LobeRays, EachStandsForTheSameLight) {
  // Thesis 3.3. Of cosⁿ about the axis lies 1 - cosⁿ⁺¹ within an angle: of N rays one in each N-th part of
  // it.
  for (const double exponent : {1.0, 7.0, 300.0})
    for (const uint32_t rays : {2u, 5u, 64u}) {
      const Vec3 axis = normalized(Vec3(0.3, 0.8, -0.2));
      const LobeRays lobe(axis, exponent, axis, rays, {0.4, 0.9});
      Vec3 sum(0);
      for (uint32_t i = 0; i < rays; ++i) {
        const double inside = 1 - std::pow(glm::dot(lobe[i], axis), exponent + 1);
        EXPECT_GE(inside * rays, i);
        EXPECT_LT(inside * rays, i + 1);
        EXPECT_NEAR(glm::length(lobe[i]), 1, 1e-12);
        sum += lobe[i] / static_cast<double>(rays);
      }
      if (rays == 64) {
        EXPECT_NEAR(glm::dot(sum, axis), (exponent + 1) / (exponent + 2), 0.01);  // the mean of cos
        EXPECT_LT(glm::length(sum - glm::dot(sum, axis) * axis), 0.03);           // from all sides alike
      }
    }
}

TEST(LobeRays, NonePassesTheSurface) {
  const Vec3 normal(0, 1, 0);
  for (const Vec3& axis : {normalized(Vec3(1, 0.05, 0)), normalized(Vec3(1, -0.05, 0))}) {
    const LobeRays lobe(axis, 2, normal, 200, {0.5, 0.25});
    for (uint32_t i = 0; i < 200; ++i) EXPECT_GE(lobe[i].y * axis.y, 0);
  }
}

TEST(SecondaryLight, TheSumOfAllWeightsIsTheCoefficient) {
  // Thesis 3.2: "The sum of all the reflective weights is the reflective coefficient of the surface. The sum
  // of all the transparent weights is the transparent coefficient." Where the light is the same from
  // everywhere many rays bring what one does, at grazing angles too.
  Probe probe(R"(
background: [0.5, 1, 2]
materials: {m: {ambient: 0, diffuse: 0, reflect: 0.5, transmit: 0.4, index: 1.2, exponent: 3}}
scene:
)" + floor_at(0, "m", 1e6));
  for (const LightingModel model : kTreeModels)
    for (const Vec3 direction : {Vec3(0, -1, 0), Vec3(1, -0.02, 0.3)}) {
      probe.settings.lighting = model;
      probe.settings.reflected_rays = probe.settings.transmitted_rays = 1;
      probe.counts = {};
      expect_color(probe.mean(Vec3(0, 1, 0), direction, 1), 0.9 * Color(0.5, 1, 2), 1e-14);
      EXPECT_EQ(probe.counts[RayKind::reflected], 1u);
      probe.settings.reflected_rays = 13;
      probe.settings.transmitted_rays = 7;
      probe.counts = {};
      expect_color(probe.mean(Vec3(0, 1, 0), direction, 3), 0.9 * Color(0.5, 1, 2), 1e-14);
      EXPECT_EQ(probe.counts[RayKind::reflected], 3 * 13u);  // Equation 3.2: N_RS and N_T, each by itself
      EXPECT_EQ(probe.counts[RayKind::transmitted], 3 * 7u);
    }
}

TEST(SecondaryLight, GlossIsThatOfPaths) {
  // Thesis 3.3: light from secondary sources "ray traced using an appropriate sampling pattern": a lamp in a
  // blurred mirror and behind frosted glass. Depth 3 holds all that there is.
  Probe probe(R"(
background: 0.1
materials:
  m: {ambient: 0, diffuse: 0, reflect: 0.5, transmit: 0.4, exponent: 40}
  lamp: {luminaire: {emission: [4, 2, 1]}}
  under: {luminaire: {emission: [1, 2, 6]}}
scene:
  - {material: lamp, polygon: {points: [[-1.6,2,-1],[0.2,2,-1],[0.2,2,1],[-1.6,2,1]]}}
)" + floor_at(0, "m") +
              floor_at(-1, "under", 0.8));
  const Vec3 origin(1, 1, 0), direction(-1, -1, 0);
  const Color path = probe.mean(origin, direction, 1 << 15);
  probe.settings.max_depth = 3;
  for (const LightingModel model : kTreeModels) {
    probe.settings.lighting = model;
    probe.settings.reflected_rays = probe.settings.transmitted_rays = 16;
    expect_color(probe.mean(origin, direction, 256), path, 0.02);
    probe.settings.reflected_rays = probe.settings.transmitted_rays = 1;
    EXPECT_GT(max_magnitude(probe.mean(origin, direction, 1) - path), 0.3);  // a mirror, and clear glass
  }
}

TEST(SecondaryLight, SmoothSurfacesSendOneRay) {
  Probe probe(R"(
background: 1
materials: {m: {ambient: 0, diffuse: 0, reflect: 0.5, transmit: 0.4}}
scene:
)" + floor_at(0, "m"));
  probe.settings.reflected_rays = probe.settings.transmitted_rays = 100;
  for (const LightingModel model : kTreeModels) {
    probe.settings.lighting = model;
    probe.counts = {};
    probe.mean(Vec3(0, 1, 0), Vec3(0, -1, 0), 1);
    EXPECT_EQ(probe.counts[RayKind::reflected], 1u);
    EXPECT_EQ(probe.counts[RayKind::transmitted], 1u);
  }
}

TEST(SecondaryLight, WeightsOfALobesRaysAreTrimmed) {
  // Thesis 2.3.4: each of four rays of 0.5 has 0.125; from there on the next surface's have 0.0156.
  Probe probe(R"(
background: 0
materials: {m: {ambient: 1, diffuse: 0, reflect: 0.5, exponent: 1e6}}
scene:
)" + floor_at(0, "m", 1e6) +
              floor_at(2, "m", 1e6));
  probe.settings.reflected_rays = 4;
  for (const LightingModel model : kTreeModels) {
    probe.settings.lighting = model;
    const double ambient = model == LightingModel::thesis ? 0 : 1;
    for (const auto& [least, bounces, rays] :
         {std::tuple{0.13, 0, 0u}, {0.125, 1, 4u}, {0.016, 1, 4u}, {0.0156, 2, 4u + 16u}}) {
      probe.settings.min_weight = least;
      probe.counts = {};
      expect_color(probe.mean(Vec3(0, 1, 0), Vec3(0, -1, 0), 1),
                   Color(ambient * (2 - std::pow(0.5, bounces))));
      EXPECT_EQ(probe.counts[RayKind::reflected], rays) << least;
    }
  }
}

TEST(SecondaryLight, ALobesRaysAreSharedWithNoDiffuseRay) {
  // Thesis 3.4 shares one reflected ray with a diffuse one. The rays of a lobe are traced by themselves.
  Probe probe(R"(
background: 1
materials:
  glossy: {ambient: 0, diffuse: 0.5, reflect: 0.4, exponent: 50}
scene:
)" + floor_at(0, "glossy", 1e6));
  probe.settings.lighting = LightingModel::thesis;
  probe.settings.diffuse_rays = 64;
  probe.settings.reflected_rays = 5;
  expect_color(probe.mean(Vec3(0, 1, 0), Vec3(0.2, -1, 0), 1), Color(0.9));
  EXPECT_EQ(probe.counts[RayKind::reflected], 5u);
  EXPECT_EQ(probe.counts[RayKind::diffuse], 64u);
}

TEST(SecondaryLight, TheInteriorsColourWeighsWhatPasses) {
  // Thesis 3.2: "The light in this term is weighted by the color of the interior of the object". Two planes
  // of 0.8 × interior: the product of both, once each.
  Probe probe(R"(
background: [1, 2, 3]
materials: {m: {ambient: 0, diffuse: 0, transmit: 0.8, interior: [1, 0.5, 0.25]}}
scene:
)" + floor_at(0, "m") +
              floor_at(-1, "m"));
  const Color expected = Color(1, 2, 3) * Color(0.64, 0.16, 0.04);
  for (const LightingModel model : {LightingModel::whitted, LightingModel::thesis, LightingModel::path}) {
    probe.settings.lighting = model;
    probe.settings.min_weight = 0.63;  // the weight bounds the share of the strongest channel
    expect_color(probe.mean(Vec3(0, 1, 0), Vec3(0.1, -1, 0), model == LightingModel::path ? 64 : 1), expected,
                 model == LightingModel::path ? 1e-9 : 1e-14);
    probe.settings.min_weight = 0.65;
    if (model != LightingModel::path) {
      expect_color(probe.mean(Vec3(0, 1, 0), Vec3(0.1, -1, 0), 1), Color(0));
    }
  }
}

TEST(SecondaryLight, FiltersTakeLightByLength) {
  // What is left after one unit of length, to the power of the length (Beer): 2 units of a box, and 1 to a
  // wall in it, there for its light. As index 1 reflects nothing, paths see the same.
  Probe probe(R"(
background: 1
ambient: [1, 2, 3]
materials:
  water: {dielectric: {index: 1, filter: [1, 0.5, 0.25]}}
  wall: {ambient: 1, diffuse: 0}
scene:
  - {material: water, box: {min: [-5, -2, -5], max: [5, 0, 5]}}
  - {material: wall, polygon: {points: [[1,-1,1],[2,-1,1],[2,-1,-1],[1,-1,-1]]}}
)");
  for (const LightingModel model : {LightingModel::path, LightingModel::whitted, LightingModel::thesis}) {
    probe.settings.lighting = model;
    expect_color(probe.mean(Vec3(0, 1, 0), Vec3(0, -1, 0), 8), Color(1, 0.25, 0.0625));
  }
  probe.settings.lighting = LightingModel::whitted;
  expect_color(probe.mean(Vec3(1.5, 1, 0), Vec3(0, -1, 0), 1), Color(1, 2, 3) * Color(1, 0.5, 0.25));
}

/// A floor under glass under a lamp that is a point.
std::string lit_through(const std::string& between) {
  return R"(
ambient: 0
lights: [{position: [0, 10, 0]}]
materials:
  matt: {ambient: 0, diffuse: 1}
  pane: {ambient: 0, diffuse: 0, transmit: 0.8, interior: [1, 0.5, 0.25], index: 1.5}
  water: {dielectric: {index: 1, filter: [1, 0.5, 0.25]}}
scene:
)" + floor_at(0, "matt") +
         between;
}

TEST(GlassShadows, AreBlockedTransparentOrNone) {
  // Thesis 2.2.4 (nonrefractive transparent objects) and 3.5.1 ("many researchers omit shadow from glass
  // objects"). Straight below the lamp a white floor shows 1.
  const Color pane(0.8, 0.4, 0.2), water(1, 0.25, 0.0625);
  const std::string two_panes = floor_at(2, "pane") + floor_at(3, "pane");
  const std::string box = "  - {material: water, box: {min: [-5, 4, -5], max: [5, 6, 5]}}\n";
  const std::string ball = "  - {material: matt, sphere: {center: [0, 3.5, 0], radius: 0.2}}\n";
  for (const auto& [between, left] :
       {std::pair{two_panes, pane * pane}, {box, water}, {two_panes + box, pane * pane * water}}) {
    Probe probe(lit_through(between)), dark(lit_through(between + ball));
    for (const LightingModel model : {LightingModel::phong, LightingModel::torrance_sparrow,
                                      LightingModel::whitted, LightingModel::thesis})
      for (const auto& [shadows, expected] : {std::pair{GlassShadows::blocked, Color(0)},
                                              {GlassShadows::transparent, left},
                                              {GlassShadows::none, Color(1)}}) {
        for (Probe* const p : {&probe, &dark}) {
          p->settings.lighting = model;
          p->settings.glass_shadows = shadows;
          p->settings.max_depth = 1;
          p->counts = {};
          expect_color(p->mean(Vec3(0.4, 1, 0), Vec3(-0.4, -1, 0), 1), p == &dark ? Color(0) : expected);
          EXPECT_EQ(p->counts[RayKind::shadow], 1u);
        }
      }
  }
}

TEST(GlassShadows, BeginInsideOfWhatTheViewerLooksThrough) {
  // A floor one unit deep in water, seen and lit from above: light is weakened on both ways.
  Probe probe(lit_through("  - {material: water, box: {min: [-8, -1, -8], max: [8, 1, 8]}}\n"));
  probe.settings.glass_shadows = GlassShadows::transparent;
  probe.settings.lighting = LightingModel::whitted;
  expect_color(probe.mean(Vec3(0.01, 2, 0), Vec3(-0.005, -1, 0), 1), Color(1, 0.25, 0.0625), 1e-4);
  // The lamp in the water, too: 12 units down to the floor, and 10 from the lamp, where nothing is between.
  Probe deep(lit_through("  - {material: water, box: {min: [-8, -1, -8], max: [8, 12, 8]}}\n"));
  deep.settings = probe.settings;
  EXPECT_NEAR(deep.mean(Vec3(1e-3, 13, 0), Vec3(-1e-4, -1, 0), 1).y, std::pow(0.5, 22), 1e-10);
}

TEST(GlassShadows, SourcesAreStillCountedOnce) {
  // Thesis 3.5: "insure each source is counted only once". A pane that changes nothing, between a floor and a
  // luminous ceiling: shadow rays find the lamp through it, so diffuse rays that go through must not.
  const auto scene = [](const std::string& pane) {
    return R"(
materials: {m: {lambertian: 1}, glossy: {color: 1, ambient: 0, diffuse: 0.6, reflect: 0.4}, pane: {ambient: 0, diffuse: 0, transmit: 1}, lamp: {luminaire: {emission: 1}}}
scene:
  - {material: lamp, polygon: {points: [[-2,1,-2],[2,1,-2],[2,1,2],[-2,1,2]]}}
)" + pane;
  };
  for (const char* material : {"m", "glossy"}) {
    Probe open(scene(floor_at(0, material))), glazed(scene(floor_at(0, material) + floor_at(0.4, "pane")));
    Color colors[2];
    for (Probe* const p : {&open, &glazed}) {
      p->settings.lighting = LightingModel::thesis;
      p->settings.max_depth = p == &open ? 2 : 3;
      p->settings.diffuse_rays = 16;
      p->settings.glass_shadows = GlassShadows::transparent;
      colors[p == &glazed] = p->mean(Vec3(1, 0.3, 0), Vec3(-1, -0.3, 0), 1 << 10);
    }
    expect_color(colors[0], colors[1], 0.005);
    EXPECT_GT(colors[0].x, 0.3);
  }
}

TEST(AmbientColour, IsTheSurfacesOrTheLights) {
  // Thesis 2.2.2: ambient light "is weighted by the color of the surface" (Equation 2.2), and as an
  // improvement "an ambient lighting component that is unweighted by the color of the surface".
  Probe probe(R"(
ambient: [0.5, 1, 0.25]
materials: {m: {color: [0.8, 0.4, 0.2], ambient: 0.5, diffuse: 0.5}}
scene:
)" + floor_at(0, "m"));
  for (const LightingModel model :
       {LightingModel::phong, LightingModel::torrance_sparrow, LightingModel::whitted}) {
    probe.settings.lighting = model;
    probe.settings.ambient_colour = AmbientColour::surface;
    expect_color(probe.mean(Vec3(0, 1, 0), Vec3(0, -1, 0), 1), Color(0.2, 0.2, 0.025));
    probe.settings.ambient_colour = AmbientColour::light;
    expect_color(probe.mean(Vec3(0, 1, 0), Vec3(0, -1, 0), 1), Color(0.25, 0.5, 0.125));
  }
}

/// `which`: of all materials.
Probe reflecting_probe(const std::string& which) {
  std::string text = R"(
ambient: [0.5, 1, 0.25]
background: [1, 2, 3]
lights: [{position: [0, 5, 0]}]
materials:
  mirror: {ambient: 0, diffuse: 0, specular: 0.3, reflect: 0.5, transmit: 0.25, reflections: WHICH}
  paint: {polished: {color: 0.5, index: 1.5}, reflections: WHICH}
  paper: {color: 0.8, ambient: 0.25, diffuse: 0.5, reflections: WHICH}
scene:
)" + floor_at(0, "mirror", 0.5) +
                     R"(
  - {material: paint, polygon: {points: [[1,0,1],[2,0,1],[2,0,-1],[1,0,-1]]}}
  - {material: paper, polygon: {points: [[3,0,1],[4,0,1],[4,0,-1],[3,0,-1]]}}
)";
  for (size_t at; (at = text.find("WHICH")) != std::string::npos;) text.replace(at, 5, which);
  return Probe(text);
}

TEST(Reflections, AreTurnedOffByTheMaterial) {
  // Shirley, Sung and Brown 2.4: "It is useful to be able to turn off reflections from a particular
  // material"; and of polished ones "from the substrate (but not the polish)".
  struct Rays {
    const char* which;
    uint64_t of_mirror, of_paint;
    uint64_t diffuse_of_paint;  ///< beside the one that the mirrored ray serves (thesis 3.4)
    uint64_t diffuse_of_paper;
  };
  const Vec3 down(0, -1, 0);
  for (const Rays& rays :
       {Rays{"true", 1, 1, 2, 3}, Rays{"specular", 1, 1, 0, 0}, Rays{"false", 0, 0, 0, 0}}) {
    Probe probe = reflecting_probe(rays.which);
    for (const LightingModel model : kTreeModels) {
      const bool is_thesis = model == LightingModel::thesis;
      probe.settings.lighting = model;
      probe.settings.diffuse_rays = 3;
      const auto look = [&](double x) {
        probe.counts = {};
        return probe.mean(Vec3(x, 1, 0.3), down, 1);
      };
      // The lamp's highlight stays, and so does what passes.
      const Color mirror = look(0.0);
      EXPECT_EQ(probe.counts[RayKind::reflected], rays.of_mirror) << rays.which;
      EXPECT_EQ(probe.counts[RayKind::transmitted], 1u);
      const double highlight = 0.3 * std::pow(5 / std::sqrt(25.09), 20);
      expect_color(mirror, Color(highlight) + (0.25 + (rays.of_mirror ? 0.5 : 0)) * Color(1, 2, 3));
      look(1.5);
      EXPECT_EQ(probe.counts[RayKind::reflected], rays.of_paint);
      EXPECT_EQ(probe.counts[RayKind::diffuse], is_thesis ? rays.diffuse_of_paint : 0);
      const Color paper = look(3.5);
      EXPECT_EQ(probe.counts[RayKind::diffuse], is_thesis ? rays.diffuse_of_paper : 0);
      // Without diffuse rays Equation 3.3 is 3.4: ambient light stands in for them.
      const double cosine = 5 / glm::length(Vec3(3.5, 5, 0.3));
      const bool is_gathered = is_thesis && rays.diffuse_of_paper > 0;
      expect_color(paper, 0.8 * (0.5 * Color(cosine) +
                                 (is_gathered ? 0.5 * Color(1, 2, 3) : 0.25 * Color(0.5, 1, 0.25))));
    }
  }
}

TEST(Reflections, OfPathsLeaveLightStraightFromSources) {
  // Without reflections a floor shows what shadow rays bring, all of it: the lamp's form factor, as by paths
  // that end after them. A lamp of few samples' noise.
  const auto scene = [](const std::string& material, const std::string& reflections) {
    return "materials: {m: {" + material + ", reflections: " + reflections +
           "}, lamp: {luminaire: {emission: 2}}}\nscene:\n"
           "  - {material: lamp, polygon: {points: "
           "[[-0.5,1,-0.5],[0.5,1,-0.5],[0.5,1,0.5],[-0.5,1,0.5]]}}\n" +
           floor_at(0, "m");
  };
  for (const auto& [material, reflections] :
       {std::pair{"lambertian: 0.8", "false"}, {"polished: {color: 0.8, exponent: 9}", "specular"}}) {
    Probe off(scene(material, reflections)), on(scene(material, "true"));
    off.settings.max_depth = on.settings.max_depth = 2;
    const Color direct = off.mean(Vec3(1, 0.5, 0), Vec3(-1, -0.5, 0), 1 << 13);
    EXPECT_EQ(off.counts[RayKind::diffuse], 0u);
    expect_color(on.mean(Vec3(1, 0.5, 0), Vec3(-1, -0.5, 0), 1 << 14), direct, 0.003);
  }
  Probe polish(reflecting_probe("specular"));
  polish.mean(Vec3(1.5, 1, 0.5), Vec3(0, -1, 0), 512);
  EXPECT_EQ(polish.counts[RayKind::diffuse], 0u);
  EXPECT_GT(polish.counts[RayKind::reflected], 0u);
}

}  // namespace
}  // namespace rayfarm
