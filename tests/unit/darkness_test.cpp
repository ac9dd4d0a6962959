// Pictures that are black for a reason: what is said about it, and that nothing is said where there is none.
#include "common/compile/darkness.h"

#include "common/lighting/renderer.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

const std::string kFloor = "{material: m, polygon: {points: [[-2,0,-2],[-2,0,2],[2,0,2],[2,0,-2]]}}";
const std::string kDown = "polygon: {points: [[-0.5,2,-0.5],[0.5,2,-0.5],[0.5,2,0.5],[-0.5,2,0.5]]}";
const std::string kUp = "polygon: {points: [[-0.5,2,-0.5],[-0.5,2,0.5],[0.5,2,0.5],[0.5,2,-0.5]]}";

/// `things`: nodes of the scene beside a floor.
CompiledScene with_floor(const std::string& things, const std::string& head = "") {
  return compile(test::load_yaml("view: {location: [0, 1, 5], look_at: [0, 1, 0]}\n" + head +
                                 "materials: {m: {lambertian: 0.5}, lamp: {luminaire: {emission: 1}}, back: "
                                 "{luminaire: {emission: 1, inward: true}}}\nscene:\n  - " +
                                 kFloor + "\n" + things));
}

bool says(const CompiledScene& compiled, const std::string& text) {
  const auto& lines = compiled.notes.lines();
  return std::any_of(lines.begin(), lines.end(),
                     [&](const std::string& line) { return line.find(text) != std::string::npos; });
}

TEST(Darkness, LampsThatShineAwayFromEverythingAreNamed) {
  const auto turned = [](const std::string& things) {
    return says(with_floor(things), ": the lamp shines away from everything else");
  };
  EXPECT_TRUE(turned("  - {material: lamp, " + kUp + "}\n"));
  EXPECT_FALSE(turned("  - {material: lamp, " + kDown + "}\n"));
  EXPECT_FALSE(turned("  - {material: back, " + kUp + "}\n"));
  EXPECT_TRUE(turned("  - {material: back, " + kDown + "}\n"));
  // Close below a ceiling it still lights nothing; something above it may be what it is for.
  const std::string ceiling =
      "  - {material: m, polygon: {points: [[-2,2.01,-2],[2,2.01,-2],[2,2.01,2],[-2,2.01,2]]}}\n";
  EXPECT_TRUE(turned("  - {material: lamp, " + kUp + "}\n" + ceiling));
  EXPECT_FALSE(turned("  - {material: lamp, " + kUp +
                      "}\n  - {material: m, sphere: {center: [0, 2.3, 0], radius: 0.2}}\n"));
  // The top of a luminous body shines at nothing; the body does.
  EXPECT_FALSE(turned("  - {material: lamp, box: {min: [-0.5, 1.9, -0.5], max: [0.5, 2, 0.5]}}\n"));
  // A sign that faces the camera.
  EXPECT_FALSE(turned("  - {material: lamp, polygon: {points: [[-1,0,3],[1,0,3],[1,1,3],[-1,1,3]]}}\n"));
  EXPECT_TRUE(turned("  - {material: lamp, polygon: {points: [[-1,0,6],[1,0,6],[1,1,6],[-1,1,6]]}}\n"));
  EXPECT_FALSE(turned("  - {material: lamp, polygon: {points: [[-1,0,6],[-1,1,6],[1,1,6],[1,0,6]]}}\n"));
  // Moved copies stand where they are moved to.
  EXPECT_TRUE(
      turned("  - {material: lamp, transform: {rotate: {axis: [0, 0, 1], degrees: 180}}, polygon: {points: "
             "[[-0.5,-2,-0.5],[0.5,-2,-0.5],[0.5,-2,0.5],[-0.5,-2,0.5]]}}\n"));
  EXPECT_FALSE(
      turned("  - {material: lamp, transform: {rotate: {axis: [0, 0, 1], degrees: 180}}, polygon: "
             "{points: [[-0.5,-2,-0.5],[-0.5,-2,0.5],[0.5,-2,0.5],[0.5,-2,-0.5]]}}\n"));
  EXPECT_FALSE(turned("  - {material: lamp, sphere: {center: [0, 3, 0], radius: 0.1}}\n"));
}

TEST(Darkness, ScenesWithoutLightAreNamed) {
  const auto is_told = [](const CompiledScene& compiled) {
    return says(compiled, "nothing lights the scene");
  };
  EXPECT_TRUE(is_told(with_floor("")));
  EXPECT_TRUE(is_told(with_floor("", "lights: [{position: [0, 3, 0], intensity: 0}]\n")));
  EXPECT_FALSE(is_told(with_floor("", "lights: [{position: [0, 3, 0]}]\n")));
  EXPECT_FALSE(is_told(with_floor("", "background: [0, 0, 0.1]\n")));
  EXPECT_FALSE(is_told(with_floor("  - {material: lamp, " + kDown + "}\n")));
  EXPECT_FALSE(
      is_told(with_floor("  - {material: lamp, cylinder: {base: [0, 1, 0], top: [0, 2, 0], radius: 1}}\n")));
  // Ambient light shows on classical materials, but not in every model.
  const CompiledScene classical =
      compile(test::load_yaml(test::view_text() + "scene: [{sphere: {center: [0, 0, 0], radius: 1}}]\n"));
  EXPECT_FALSE(is_told(classical));
  RenderSettings settings;
  EXPECT_FALSE(is_dark(classical.scene, settings));
  settings.lighting = LightingModel::path;
  EXPECT_TRUE(is_dark(classical.scene, settings));
  settings.lighting = LightingModel::thesis;
  EXPECT_TRUE(is_dark(classical.scene, settings));
  settings.diffuse_reach = 1;
  EXPECT_FALSE(is_dark(classical.scene, settings));
  EXPECT_TRUE(is_told(compile(test::load_yaml(
      test::view_text() + "ambient: 0\nscene: [{sphere: {center: [0, 0, 0], radius: 1}}]\n"))));
}

TEST(Darkness, ACameraThatSeesNothingIsNamed) {
  const auto problem = [](const std::string& view, const std::string& things) {
    const CompiledScene compiled =
        compile(test::load_yaml("view: {" + view + "}\nscene: [" + things + "]\n"));
    return nothing_in_view(compiled.scene, 0, 640, 480).value_or("");
  };
  const std::string ball = "{sphere: {center: [0, 0, 0], radius: 1}}";
  EXPECT_EQ(problem("location: [0, 0, 5], look_at: [0, 0, 0]", ball), "");
  EXPECT_NE(problem("location: [0, 0, 5], look_at: [0, 0, 9]", ball).find("no object lies in its view"),
            std::string::npos);
  EXPECT_NE(problem("location: [0, 0, 5], look_at: [9, 0, 5]", ball), "");
  // Just beside the picture's edge, and just inside: half of 45 degrees, and what a radius of 1 takes.
  const auto turned = [&](double degrees) {
    const double a = degrees * 3.14159265358979 / 180;
    return problem(fmt::format("location: [0, 0, 5], direction: [{}, 0, {}]", std::sin(a), -std::cos(a)),
                   ball);
  };
  EXPECT_EQ(turned(22.5 + 11), "");
  EXPECT_NE(turned(22.5 + 12), "");
  // Tiny, far, and of any kind: it is there.
  for (const char* thing :
       {"{sphere: {center: [0.1, 0.2, -900], radius: 0.00001}}",
        "{triangles: {points: [[0.1, 0, -900], [0.1001, 0, -900], [0.1, 0.0001, -900]], triangles: [[0, 1, "
        "2]]}}",
        "{polygon: {points: [[0, 0, -9], [2e-5, 2e-5, -9], [0, 1e-5, -9], [-2e-5, 2e-5, -9]]}}",
        "{transform: {translate: [3, 0, 0]}, sphere: {center: [-3, 0, 0], radius: 0.001}}"})
    EXPECT_EQ(problem("location: [0, 0, 5], look_at: [0, 0, 0]", thing), "") << thing;
  // Around the camera, or with a lens: no corner or centre in view, but rays meet it.
  EXPECT_EQ(problem("location: [0, 0, 0.5], direction: [0, 0, 1]", ball), "");
  EXPECT_EQ(problem("location: [0, 0, 5], look_at: [0, 0, 0], lens: {radius: 0.1, focus: 5}", ball), "");
  EXPECT_EQ(problem("location: [0, 0, 5], direction: [0, 0, -1]",
                    "{polygon: {points: [[-99, -99, 0], [99, -99, 0], [99, 99, 0], [-99, 99, 0]]}}"),
            "");
  // Through the hole of a frame: its box is in view, no ray meets it.
  EXPECT_NE(problem("location: [0, 0, 5], direction: [0, 0, -1]",
                    "{cylinder: {base: [0, 0, -1], top: [0, 0, 1], radius: 9}}")
                .find("of 3072 rays"),
            std::string::npos);
  EXPECT_EQ(problem("location: [0, 0, 5], direction: [0, 0, -1]", ""), "the scene holds no objects");
}

TEST(Darkness, SpotsThatShinePastEverythingAreNamed) {
  const auto is_named = [](const std::string& spot) {
    return says(with_floor("", "lights: [{color: 1, position: [3, 3, 0], " + spot + "}]\n"),
                "shines past everything");
  };
  // The floor's nearest edge is at x = 2, seen from (3, 3, 0) at 18.4° from straight down.
  EXPECT_TRUE(is_named("direction: [0, 1, 0], angle: 5, dark_angle: 10"));
  EXPECT_TRUE(is_named("direction: [0, -1, 0], angle: 5, dark_angle: 16"));
  EXPECT_FALSE(is_named("direction: [0, -1, 0], angle: 5, dark_angle: 20"));
  EXPECT_FALSE(is_named("direction: [-1, -1, 0], angle: 1, dark_angle: 2"));
  EXPECT_FALSE(is_named("direction: [0, 1, 0], angle: 90, dark_angle: 179"));
}

TEST(Darkness, WhatIsSaidOfALampTurnedAwayFitsTheWayItShines) {
  EXPECT_TRUE(says(with_floor("  - {material: lamp, " + kUp + "}\n"),
                   "run counter-clockwise; turn their order round, or write"));
  EXPECT_TRUE(says(with_floor("  - {material: back, " + kDown + "}\n"),
                   "run clockwise; turn their order round, or leave out"));
}

TEST(Darkness, WhatCancelsItselfIsNamedAtItsPlace) {
  EXPECT_TRUE(
      says(with_floor("  - {material: m, polygon: {points: [[-1,-1,0],[1,1,0],[1,-1,0],[-1,1,0]]}}\n"),
           "scene.yaml:5:"));
  EXPECT_TRUE(
      says(with_floor("  - {material: m, polygon: {points: [[-1,-1,0],[1,1,0],[1,-1,0],[-1,1,0]]}}\n"),
           "1 polygon or triangle without area, or whose parts cancel each other, is left out"));
}

TEST(Darkness, RenderersCountEyeRaysThatMeetAnythingHoweverTheFrameIsCut) {
  const CompiledScene compiled = compile(test::load_yaml(
      test::view_text() + "background: 1\nscene: [{sphere: {center: [0, 0, 0], radius: 1}}]\n"));
  RenderSettings settings;
  settings.width_px = settings.height_px = 40;
  settings.crop = {0, 0, 40, 40};
  const auto check = [&](uint64_t most_missed) {
    Renderer renderer(compiled.scene, settings);
    const RenderedPixels whole = renderer.render(0, settings.crop, [] {});
    uint64_t hits = 0;
    for (const PixelRect& rect :
         {PixelRect{0, 0, 17, 40}, PixelRect{17, 0, 40, 13}, PixelRect{17, 13, 40, 40}})
      hits += renderer.render(0, rect, [] {}).eye_hits;
    EXPECT_EQ(hits, whole.eye_hits);
    EXPECT_GT(whole.eye_hits, 0u);
    EXPECT_LT(whole.eye_hits + most_missed, whole.counts[RayKind::primary]);
    EXPECT_EQ(whole.not_finite, 0u);
    return whole;
  };
  const uint64_t once = check(100).eye_hits;
  // The sphere's silhouette is a circle of 40 / (2 tan 22.5° sqrt(24)) pixels.
  EXPECT_NEAR(static_cast<double>(once), 3.14159 * 9.856 * 9.856, 12);
  settings.samples = 4;
  check(400);
  settings.adaptive_contrast = 0.01;
  check(100);
  settings = {};
  settings.width_px = settings.height_px = 40;
  settings.crop = {0, 0, 40, 40};
  settings.sampling = SamplingPattern::corners;
  check(100);
  settings.sampling = SamplingPattern::sobol;
  settings.lighting = LightingModel::path;
  EXPECT_EQ(check(100).eye_hits, once);
}

TEST(Darkness, RenderersCountPixelsThatAreNoNumbers) {
  // Light of 1e308 twice is infinite.
  CompiledScene compiled = compile(test::load_yaml(
      test::view_text() +
      "lights: [{position: [0, 0, 5]}, {position: [0, 0, 5]}]\nscene: [{sphere: {center: [0, 0, "
      "0], radius: 1}}]\n"));
  std::vector<Light> lights(compiled.scene.lights.begin(), compiled.scene.lights.end());
  for (Light& light : lights) light.color = Color(1.7e308);
  compiled.scene.lights = lights;
  RenderSettings settings;
  settings.width_px = settings.height_px = 20;
  settings.crop = {0, 0, 20, 20};
  settings.pixel_format = PixelFormat::rgb8;
  const RenderedPixels rendered = Renderer(compiled.scene, settings).render(0, settings.crop, [] {});
  EXPECT_GT(rendered.not_finite, 20u);
  EXPECT_LE(rendered.not_finite, rendered.eye_hits);
}

}  // namespace
}  // namespace rayfarm
