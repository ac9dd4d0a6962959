// Lamps of every shape: which primitives are lamps, that nothing but what stands before them shades them, and
// what they bring.
#include <functional>
#include <numbers>

#include "common/lighting/light_sampling.h"
#include "common/sampling/random.h"
#include "tests/unit/probe.h"

namespace rayfarm {
namespace {

using std::numbers::pi;

Probe with_lamp(const std::string& lamp, const std::string& luminaire = "{emission: 1}") {
  return Probe("materials: {lamp: {luminaire: " + luminaire + "}}\nscene: [{material: lamp, " + lamp +
               "}]\n");
}

std::string ring_of_points(int corners, double radius, const std::string& third) {
  std::string text;
  for (int i = 0; i < corners; ++i)
    text += fmt::format("{}[{}, {}, {}]", i ? ", " : "", radius * std::cos(2 * pi * i / corners),
                        radius * std::sin(2 * pi * i / corners), third);
  return text;
}

/// A white floor, seen straight from above at (x, 0, 0), under a lamp.
Probe over_floor(const std::string& lamp, const std::string& luminaire) {
  return Probe("materials: {m: {lambertian: 1}, lamp: {luminaire: " + luminaire +
               "}}\nscene:\n  - {material: m, polygon: {points: [[-9,0,-9],[-9,0,9],[9,0,9],[9,0,-9]]}}\n"
               "  - {material: lamp, " +
               lamp + "}\n");
}
double seen_on_floor(Probe& probe, double x, LightingModel model, uint32_t samples) {
  probe.settings.lighting = model;
  probe.settings.max_depth = 1;
  return probe.mean(Vec3(x, 1, 0), Vec3(0, -1, 0), samples).x;
}

TEST(Lamps, SmallSpheresBringTheirLight) {
  // Straight below a sphere of radius R and radiance L, d away, the floor receives π L R² / d².
  constexpr double kDistance = 5.13;
  for (const double ratio : {3.0, 17.0, 102.6, 513.0, 5e3, 1e5})
    for (const bool is_moved : {false, true}) {
      const double radius = kDistance / ratio;
      SCOPED_TRACE(fmt::format("distance / radius {}{}", ratio, is_moved ? ", moved and scaled" : ""));
      const std::string luminaire = fmt::format("{{emission: {}}}", ratio * ratio);
      Probe probe = over_floor(
          is_moved
              ? fmt::format("transform: [{{scale: 0.001}}, {{translate: [0, {}, 0]}}], sphere: {{center: "
                            "[30, 0, 0], radius: {}}}",
                            kDistance, 1000 * radius)
              : fmt::format("sphere: {{center: [0, {}, 0], radius: {}}}", kDistance, radius),
          luminaire);
      // Moved spheres are sampled by area, so half of the samples bring nothing.
      EXPECT_NEAR(seen_on_floor(probe, is_moved ? 0.03 : 0, LightingModel::phong, 4096), 1,
                  is_moved ? 0.05 : 0.001);
    }
}

TEST(Lamps, NothingShadesThemButWhatStandsBeforeThem) {
  for (const std::string& lamp : std::vector<std::string>{
           "sphere: {center: [0, 5.13, 0], radius: 0.01}", "sphere: {center: [0, 5.13, 0], radius: 0.00006}",
           "transform: {translate: [0, 5, 0]}, sphere: {center: [0, 0.13, 0], radius: 0.0001}",
           "transform: [{scale: [1, 2, 1]}, {translate: [0, 5, 0]}], sphere: {center: [0, 0.1, 0], radius: "
           "0.001}",
           "transform: {translate: [-100000, 0, 100000]}, sphere: {center: [100000, 5, -100000], radius: "
           "0.01}",
           "polygon: {points: [[0.1, 2.9, 0.1], [0.4, 2.9, 0.1], [0.4, 2.9, 0.4], [0.1, 2.9, 0.4]]}",
           "transform: {rotate: {axis: [1, 0, 0], degrees: 90}}, polygon: {points: [" +
               ring_of_points(9, 0.7, "-2.9") + "]}",
           // Off its plane by no more than a file's digits explain.
           "polygon: {points: [[0, 2.90001, 0], [1, 2.9, 0], [1.7, 2.89999, 0.3], [1.2, 2.9, 0.4], [0.6, "
           "2.90001, 0.2], [0, 2.9, 0.4]]}"}) {
    SCOPED_TRACE(lamp);
    const Probe probe = with_lamp(lamp);
    ASSERT_EQ(probe.compiled.scene.lights.size(), 1u);
    uint32_t sent = 0, blocked = 0;
    for (uint32_t i = 0; i < 20'000; ++i) {
      const auto r = random_pair(3, 0, {0, 0, i}, 0), at = random_pair(3, 0, {0, 0, i}, 1);
      const Vec3 p(6 * at[0] - 3, 0, 6 * at[1] - 3);
      const LightSample sample =
          sample_light(probe.compiled.scene, probe.pose, probe.compiled.scene.lights[0], p, {r[0], r[1]});
      if (!(sample.pdf > 0)) continue;
      ++sent;
      if (any_hit(probe.compiled.scene, probe.pose, {p, sample.target - p, 1})) ++blocked;
    }
    EXPECT_GT(sent, 8000u);
    EXPECT_EQ(blocked, 0u);
  }
}

TEST(Lamps, EveryPlanarPolygonIsOne) {
  for (const auto& [lamp, count] : std::vector<std::pair<std::string, size_t>>{
           {"polygon: {points: [[0.1, 2.9, 0.1], [0.4, 2.9, 0.1], [0.4, 2.9, 0.4], [0.1, 2.9, 0.4]]}", 1},
           {"box: {min: [0.1, 0.2, 0.3], max: [0.4, 0.7, 0.9]}", 6},
           {"polygon: {points: [" + ring_of_points(9, 1, "0") + "]}", 1},
           {"polygon: {points: [" + ring_of_points(1000, 1, "0.1") + "]}", 1},
           {"polygon: {points: [[0, 0, 0], [2, 2, 0], [0, 1, 0], [-2, 2, 0]]}", 1},
           {"triangles: {points: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.1, 0.1, 3]], triangles: [[0, 1, 2], "
            "[0, 1, "
            "3]]}",
            2},
           {"cylinder: {base: [0, 0, 0], top: [0, 1, 0], radius: 1}", 0},
           {"polygon: {points: [[0, 0, 0], [1, 1, 0], [1, 0, 0], [0, 1.5, 0]]}", 0}}) {
    SCOPED_TRACE(lamp);
    const CompiledScene compiled = with_lamp(lamp).compiled;
    EXPECT_EQ(compiled.scene.lights.size(), count);
    const auto& notes = compiled.notes.lines();
    const bool is_told = std::any_of(notes.begin(), notes.end(), [](const std::string& line) {
      return line.find("scene.yaml:3:") != std::string::npos && line.find("is no lamp") != std::string::npos;
    });
    EXPECT_EQ(is_told, count == 0);
  }
}

TEST(Lamps, PolygonsBringTheirLightInEveryModel) {
  // The sums over small squares of the part of π L that each sends down.
  struct Shape {
    std::string lamp;
    std::function<bool(double, double)> holds;  // (x, z) of [-1, 1]²
  };
  const std::vector<Shape> shapes{
      {"polygon: {points: [[-0.15, 2.9, -0.15], [0.15, 2.9, -0.15], [0.15, 2.9, 0.15], [-0.15, 2.9, 0.15]]}",
       [](double x, double z) { return std::max(std::abs(x), std::abs(z)) < 0.15; }},
      {"polygon: {points: [[0, 2.9, -0.5], [0.9, 2.9, 0.7], [0, 2.9, 0.1], [-0.9, 2.9, 0.7]]}",
       [](double x, double z) {
         return z > -0.5 + 1.2 / 0.9 * std::abs(x) && z < 0.1 + 0.6 / 0.9 * std::abs(x);
       }},
      {"polygon: {points: [[-0.9, 2.9, -0.9], [0.9, 2.9, -0.9], [0.9, 2.9, 0.9], [-0.9, 2.9, 0.9], [-0.9, "
       "2.9, "
       "-0.9], [-0.8, 2.9, -0.8], [-0.8, 2.9, 0.8], [0.8, 2.9, 0.8], [0.8, 2.9, -0.8], [-0.8, 2.9, -0.8]]}",
       [](double x, double z) {
         const double r = std::max(std::abs(x), std::abs(z));
         return r > 0.8 && r < 0.9;
       }}};
  for (const Shape& shape : shapes) {
    SCOPED_TRACE(shape.lamp);
    double expected = 0;
    constexpr int kSteps = 400;
    for (int i = 0; i < kSteps; ++i)
      for (int j = 0; j < kSteps; ++j) {
        const double x = -1 + (i + 0.5) * 2 / kSteps, z = -1 + (j + 0.5) * 2 / kSteps;
        const double square = (x - 0.2) * (x - 0.2) + 2.9 * 2.9 + z * z;
        if (shape.holds(x, z)) expected += 2.9 * 2.9 / (square * square) * 4 / (kSteps * kSteps) / pi;
      }
    Probe probe = over_floor(shape.lamp, "{emission: 1}");
    for (const LightingModel model :
         {LightingModel::phong, LightingModel::whitted, LightingModel::thesis, LightingModel::path}) {
      probe.settings.min_weight = 0;
      probe.settings.lighting = model;
      probe.settings.max_depth = 2;
      EXPECT_NEAR(probe.mean(Vec3(0.2, 1, 0), Vec3(0, -1, 0), 4096).x / expected, 1, 0.02);
    }
  }
}

TEST(Lamps, InwardSpheresAreFurnaces) {
  // Inside a sphere that shines inward with radiance L every place receives π L, so a surface of albedo a
  // shows a L.
  for (const std::string& sphere : std::vector<std::string>{
           "sphere: {center: [0, 0, 0], radius: 2}",
           "transform: [{scale: 2}, {translate: [0.3, 0, 0]}], sphere: {center: [0, 0, 0], radius: 1}"})
    for (const LightingModel model : {LightingModel::phong, LightingModel::path}) {
      Probe probe(
          "materials: {m: {lambertian: 0.5}, sky: {luminaire: {emission: [1, 2, 3], inward: true}}}\n"
          "scene:\n  - {material: sky, " +
          sphere +
          "}\n  - {material: m, polygon: {points: [[0, 0.4, 0], [0, 0.4, 0.2], [0.2, 0.5, 0.2], [0.2, 0.5, "
          "0]]}}\n");
      probe.settings.lighting = model;
      const Color seen = probe.mean(Vec3(0.1, 1, 0.1), Vec3(0, -1, 0), 1 << 14);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c] / (c + 1), 0.5, 0.01);
      EXPECT_NEAR(probe.mean(Vec3(0.1, 1, 0.1), Vec3(0, 1, 0.3), 1).y, 2, 1e-12);
      EXPECT_EQ(probe.mean(Vec3(0, 0, 9), Vec3(0, 0, -1), 1).y, 0);  // nothing leaves it outwards
    }
  // A polygon of such a material shines from its back.
  const std::string down = "polygon: {points: [[-1, 2, -1], [1, 2, -1], [1, 2, 1], [-1, 2, 1]]}";
  Probe front = over_floor(down, "{emission: 1}"), back = over_floor(down, "{emission: 1, inward: true}");
  EXPECT_GT(seen_on_floor(front, 0, LightingModel::phong, 16), 0.1);
  EXPECT_EQ(seen_on_floor(back, 0, LightingModel::phong, 16), 0);
}

TEST(Lamps, InwardSpheresAreSampledAsTheirDensitySays) {
  // The light of the whole sphere about a place off its middle: 4π.
  const Probe probe = with_lamp("sphere: {center: [0.2, 0.3, 1], radius: 2}", "{emission: 1, inward: true}");
  const Scene& scene = probe.compiled.scene;
  const Vec3 p(0.5, -0.7, 0.1);
  double sum = 0;
  constexpr uint32_t kSamples = 1 << 16;
  for (uint32_t i = 0; i < kSamples; ++i) {
    const auto r = random_pair(3, 0, {0, 0, i}, 0);
    const LightSample sample = sample_light(scene, probe.pose, scene.lights[0], p, {r[0], r[1]});
    ASSERT_GT(sample.pdf, 0);
    sum += 1 / sample.pdf / kSamples;
    const Ray ray{p, sample.to_light};
    const Hit hit = closest_hit(scene, probe.pose, ray);
    ASSERT_TRUE(hit.is_hit());
    const Surface surface = eval_surface(scene, probe.pose, ray, hit);
    ASSERT_NEAR(light_pdf(scene, probe.pose, scene.lights[0], p, surface) / sample.pdf, 1, 1e-6);
  }
  EXPECT_NEAR(sum / (4 * pi), 1, 0.01);
}

TEST(Lamps, CopiesHaveALimit) {
  // Six times ten copies of copies of one lamp: a million.
  std::string text = test::view_text() +
                     "materials: {lamp: {luminaire: {emission: 1}}}\nobjects:\n  a0: "
                     "{material: lamp, sphere: {center: [0, 0, 0], radius: 1}}\n";
  for (int i = 1; i <= 6; ++i) {
    text += fmt::format("  a{}: {{group: [", i);
    for (int k = 0; k < 10; ++k)
      text +=
          fmt::format("{}{{use: a{}, transform: {{translate: [{}, 0, 0]}}}}", k ? ", " : "", i - 1, k + 1);
    text += "]}\n";
  }
  const std::string error = test::error_of(text + "scene: [{use: a6}]\n");
  EXPECT_NE(error.find("more than 100000 luminous primitives"), std::string::npos) << error;
  EXPECT_NE(error.find("fewer copies"), std::string::npos) << error;
}

TEST(Thesis, JitterTakesTheBiasFromBandsOnCurvedBodies) {
  // Between concentric spheres: the inner one, half a sphere's radius .6 wide, fills sin² θ < .36 of what
  // each place of the outer one sees. It is a quadric, so that diffuse rays alone find its light.
  Probe probe(R"(
materials: {m: {lambertian: 1}, lamp: {luminaire: {emission: 1}}}
scene:
  - {material: m, sphere: {center: [0, 0, 0], radius: 1}}
  - {material: lamp, quadric: {coefficients: [1, 1, 1, 0, 0, 0, 0, 0, 0, -0.36]}}
)");
  probe.settings.lighting = LightingModel::thesis;
  probe.settings.max_depth = 2;
  probe.settings.min_weight = 0;
  probe.settings.diffuse_rays = 64;
  const auto mean = [&](bool has_jitter) {
    probe.settings.diffuse_jitter = has_jitter;
    const SamplingTables tables(probe.settings, 0);
    constexpr int kPlaces = 2000;
    double sum = 0;
    std::mt19937 random(3);
    for (int i = 0; i < kPlaces; ++i) {
      const Vec3 d = normalized(test::random_point(random, 1));
      const Ray ray{0.8 * d, d};
      const SampleId id{i, 1, 0};
      Color color;
      make_integrator(probe.settings.lighting)
          ->trace({probe.compiled.scene, probe.pose, tables}, RayPacket(std::span(&ray, 1)),
                  std::span(&id, 1), probe.counts, &color);
      sum += color.x / kPlaces;
    }
    return sum / 0.36;
  };
  EXPECT_NEAR(mean(false), 21 / 64.0 / 0.36, 1e-9);  // one ray and two bands of ten: 9 % too little
  EXPECT_NEAR(mean(true), 1, 0.005);
}

}  // namespace
}  // namespace rayfarm
