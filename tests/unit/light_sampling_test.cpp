// Sources of light: their samples against the densities that they claim, and environments.
#include <cstring>

#include "common/image/image_file.h"
#include "common/lighting/environment.h"
#include "common/lighting/light_choice.h"
#include "common/lighting/renderer.h"
#include "tests/unit/chi_square.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

using std::numbers::pi;

/// A scene lit by what `text` describes, seen from a point.
struct Lit {
  explicit Lit(const std::string& text)
      : compiled(compile(test::load_yaml(test::view_text() + text))),
        frame_pose(compiled.scene),
        pose(frame_pose.at(0)) {}
  CompiledScene compiled;
  FrameState frame_pose;
  Pose pose;
};

/// The density of a direction from `p` to the scene's only light.
double lamp_pdf(const Lit& lit, const Vec3& p, const Vec3& d) {
  const Ray ray{p, d};
  const Hit hit = closest_hit(lit.compiled.scene, lit.pose, ray);
  if (!hit.is_hit()) return 0;
  const Surface surface = eval_surface(lit.compiled.scene, lit.pose, ray, hit);
  return surface.is_front ? light_pdf(lit.compiled.scene, lit.pose, lit.compiled.scene.lights[0], p, surface)
                          : 0;
}

Lit lit_by_lamp(const std::string& lamp) {
  return Lit("materials: {lamp: {luminaire: {emission: 1}}}\nscene: [{material: lamp, " + lamp + "}]\n");
}

TEST(LightSampling, LuminairesAreSampledAsTheirDensitySays) {
  for (const char* lamp :
       {"sphere: {center: [0.2, 0.3, 1], radius: 0.7}",
        "polygon: {points: [[-1, -0.6, 0.5], [-1.2, 0.8, 0.5], [0.5, 1.2, 0.5], [1.4, 0, 0.5], [0.6, -1, "
        "0.5]]}",
        "polygon: {points: [[1, -0.3, 0.7], [0.6, -0.9, 0.7], [-0.1, -1.1, 0.7], [-0.9, -0.7, 0.7], [-1.3, "
        "0.1, "
        "0.7], [-0.7, 0.9, 0.7], [0.1, 1.1, 0.7], [0.7, 0.9, 0.7], [1.1, 0.3, 0.7]]}",
        "polygon: {points: [[-1.5, -1, 0.5], [0, 1.5, 0.5], [1.5, -1, 0.5], [0, 0.3, 0.5]]}",
        "polygon: {points: [[-1, -1, 0.5], [-1, 1, 0.5], [1, 1, 0.5], [1, -1, 0.5], [-1, -1, 0.5], [-0.5, "
        "-0.5, "
        "0.5], [0.6, -0.5, 0.5], [0.6, 0.7, 0.5], [-0.5, 0.7, 0.5], [-0.5, -0.5, 0.5]]}",
        "transform: {rotate: {axis: [1, 2, 3], degrees: 20}}, polygon: {points: [[-1, -0.6, 0.5], [-1.2, "
        "0.8, 0.5], "
        "[1.5, 1.2, 0.5]]}",
        "triangles: {points: [[-1, -1, 0.5], [0, 1.5, 0.6], [1, -1, 0.7]], triangles: [[0, 1, 2]]}"}) {
    SCOPED_TRACE(lamp);
    const Lit lit = lit_by_lamp(lamp);
    const Vec3 p(0.05, -0.02, 0.01);
    int samples = 0;
    check_directions(
        [&](const Vec2& u) {
          const LightSample sample =
              sample_light(lit.compiled.scene, lit.pose, lit.compiled.scene.lights[0], p, u);
          samples += sample.pdf > 0 ? 1 : 0;
          return sample.to_light;
        },
        [&](const Vec3& d) { return lamp_pdf(lit, p, d); });
    EXPECT_GT(samples, 100'000);
  }
}

TEST(LightSampling, MovedSpheresAreSampledAsTheirDensitySays) {
  // Their density has no bound at the silhouette, so integrals are compared: of 1 and of a cosine.
  const Lit lit = lit_by_lamp(
      "transform: [{scale: [1, 0.6, 1]}, {translate: [0, 0.5, 1]}], sphere: {center: [0, 0, 0], radius: "
      "0.6}");
  const Vec3 p(0.05, -0.02, 0.01);
  Vec2 sampled(0), expected(0);
  constexpr uint32_t kSamples = 16 * kPoints;
  for (uint32_t i = 0; i < kSamples; ++i) {
    const LightSample sample =
        sample_light(lit.compiled.scene, lit.pose, lit.compiled.scene.lights[0], p, random_point(i, 3));
    if (!(sample.pdf > 0)) continue;
    if (i % 16 == 0) {
      ASSERT_NEAR(lamp_pdf(lit, p, sample.to_light), sample.pdf, 1e-6 * sample.pdf);
    }
    sampled += Vec2(1, sample.to_light.y) / (sample.pdf * kSamples);
  }
  constexpr int kSteps = 600;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) {
      const double z = -1 + 2 * (i + 0.5) / kSteps, phi = 2 * pi * (j + 0.5) / kSteps,
                   s = std::sqrt(1 - z * z);
      const Vec3 d(s * std::cos(phi), s * std::sin(phi), z);
      if (lamp_pdf(lit, p, d) > 0) expected += Vec2(1, d.y) * (4 * pi / (kSteps * kSteps));
    }
  EXPECT_NEAR(sampled.x / expected.x, 1, 0.003);
  EXPECT_NEAR(sampled.y / expected.y, 1, 0.003);
}

TEST(LightSampling, EnvironmentsAreSampledAsTheirDensitySays) {
  // A dim sky with one bright and some dark patches.
  const std::string path = test::write_environment(32, 16, [](int x, int y) {
    return x > 20 && x < 24 && y == 4 ? 50.0f : y > 12 ? 0.0f : 0.5f + 0.03f * static_cast<float>(x);
  });
  const Lit lit("environment: {file: " + path +
                ", turn: 70}\nscene: [{sphere: {center: [0, 0, 0], radius: 1}}]\n");
  const Scene& scene = lit.compiled.scene;
  check_directions([&](const Vec2& u) { return sample_environment(scene, u).to_light; },
                   [&](const Vec3& d) { return environment_pdf(scene, d); });
  for (uint32_t i = 0; i < 1000; ++i) {
    const LightSample sample = sample_environment(scene, random_point(i, 5));
    EXPECT_NEAR(sample.pdf, environment_pdf(scene, sample.to_light), 1e-9 * sample.pdf);
    EXPECT_NEAR(sample.incident.x * sample.pdf, eval_background(scene, sample.to_light).x, 1e-9);
  }
}

TEST(LightSampling, EnvironmentsStandAsTheManualSays) {
  // Column 0 begins at +x, a quarter of the way lies +z; the first row is the top.
  const std::string path = test::write_environment(
      64, 32, [](int x, int y) { return static_cast<float>(y < 16 ? 100 : 0) + static_cast<float>(x / 16); });
  const auto seen = [](const Lit& lit, const Vec3& d) {
    return eval_background(lit.compiled.scene, normalized(d)).x;
  };
  const std::string scene = "\nscene: [{sphere: {center: [0, 0, 0], radius: 1}}]\n";
  const Lit lit("environment: {file: " + path + "}" + scene);
  EXPECT_NEAR(seen(lit, Vec3(1, 0.5, 1)), 100, 1e-9);
  EXPECT_NEAR(seen(lit, Vec3(-1, 0.5, 1)), 101, 1e-9);
  EXPECT_NEAR(seen(lit, Vec3(-1, -0.5, -1)), 2, 1e-9);
  EXPECT_NEAR(seen(lit, Vec3(1, -0.5, -1)), 3, 1e-9);
  EXPECT_NEAR(seen(lit, Vec3(0.001, 1, 0.002)), 100, 1e-9);  // the poles belong to their own rows
  const Lit turned("environment: {file: " + path + ", turn: 90, intensity: 2}" + scene);
  EXPECT_NEAR(seen(turned, Vec3(1, 0.5, 1)), 202, 1e-9);
  EXPECT_NE(test::error_of(test::view_text() + "background: 1\nenvironment: {file: " + path + "}" + scene)
                .find("not both"),
            std::string::npos);
  EXPECT_NE(test::error_of(test::view_text() + "environment: {file: none.exr}" + scene).find("none.exr"),
            std::string::npos);
}

TEST(LightSampling, EnvironmentsLightPathsExactly) {
  // A white floor under a sky with a small sun: L = 1 / π ∫ L_i cos θ dω. And a uniform sky is a furnace.
  const auto radiance = [](int x, int y) { return x == 40 && y == 9 ? 900.0f : y < 16 ? 1.0f : 0.0f; };
  const std::string path = test::write_environment(64, 32, radiance);
  const Lit lit("environment: {file: " + path +
                "}\nmaterials: {m: {lambertian: 1}}\nscene: [{material: m, polygon: {points: "
                "[[-9,0,-9],[-9,0,9],[9,0,9],[9,0,-9]]}}]\n");
  double expected = 0;
  constexpr int kSteps = 2000;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) {
      const double polar = pi / 2 * (i + 0.5) / kSteps, azimuth = 2 * pi * (j + 0.5) / kSteps,
                   sine = std::sin(polar);
      const Vec3 d(sine * std::cos(azimuth), std::cos(polar), sine * std::sin(azimuth));
      expected += eval_background(lit.compiled.scene, d).x * d.y * sine;
    }
  expected *= pi / 2 / kSteps * 2 * pi / kSteps / pi;
  RenderSettings settings;
  settings.lighting = LightingModel::path;
  settings.samples = 1 << 14;
  const SamplingTables tables(settings, 0);
  RayCounts counts;
  Color sum(0);
  for (uint32_t i = 0; i < settings.samples; ++i) {
    const Ray ray{Vec3(0, 1, 0), Vec3(0, -1, 0)};
    const SampleId id{1, 2, i};
    Color color;
    make_integrator(settings.lighting)
        ->trace({lit.compiled.scene, lit.pose, tables}, RayPacket(std::span(&ray, 1)), std::span(&id, 1),
                counts, &color);
    sum += color;
  }
  EXPECT_NEAR(sum.x / settings.samples / expected, 1, 0.002);
}

}  // namespace
}  // namespace rayfarm
