// Lights as items of the object tree: "an item is a light or an object"; "a cluster ... groups together other
// clusters and/or items" (Weghorst, Hooper and Greenberg 1984, Table I), moved by the matrices on the way to
// them (thesis 2.6.1).
#include <numbers>

#include "common/lighting/light_sampling.h"
#include "common/lighting/renderer.h"
#include "tests/unit/probe.h"

namespace rayfarm {
namespace {

using std::numbers::pi;

std::vector<std::byte> render(const std::string& text, LightingModel model, int frame = 0,
                              double shutter = 0) {
  const CompiledScene compiled = compile(test::load_yaml(text));
  RenderSettings settings = test::picture_settings(32, 24, model);
  settings.samples = 3;
  settings.max_depth = 3;
  settings.shutter = shutter;
  return Renderer(compiled.scene, settings).render(frame, settings.crop, [] {}).pixels;
}

const std::string kFloor = test::view_text() + "materials: {m: {color: 0.8, specular: 0.2}}\n";
const std::string kThings =
    "  - {material: m, polygon: {points: [[-4, -1, 4], [4, -1, 4], [4, -1, -4], [-4, -1, -4]]}}\n"
    "  - {material: m, sphere: {center: [0.2, 0, 0], radius: 0.7}}\n";

/// turned.ies: a lamp that shines differently on each side.
void write_turned_lamp() {
  test::write_temporary(
      "turned.ies",
      "TILT=NONE\n1 1 1 3 4 1 1 0 0 0\n1 1 1\n0 60 120\n0 90 180 360\n5 7 1\n9 2 0\n4 3 2\n1 6 3\n");
}

const std::vector<std::string>& kinds() {
  static const std::vector<std::string> all = [] {
    write_turned_lamp();
    return std::vector<std::string>{
        "{position: [1, 2, 1.5], color: [0.9, 0.8, 0.6]}",
        "{position: [1, 2, 1.5], falloff: true, color: 5, intensity: 2}",
        "{position: [1, 2, 1.5], direction: [-0.4, -1, -0.6], angle: 15, dark_angle: 50, color: 9}",
        "{position: [1, 2, 1.5], ies: turned.ies, direction: [-0.4, -1, -0.6], zero: [1, 0.2, 0]}",
        "{direction: [-0.4, -1, -0.6], color: 0.7}"};
  }();
  return all;
}

TEST(TreeLights, WithoutATransformTheyAreTheListedOnes) {
  for (const std::string& light : kinds())
    for (const LightingModel model : {LightingModel::whitted, LightingModel::path})
      EXPECT_EQ(render(kFloor + "lights: [" + light + "]\nscene:\n" + kThings, model),
                render(kFloor + "scene:\n" + kThings + "  - {group: [{light: " + light + "}]}\n", model))
          << light;
}

TEST(TreeLights, MatricesAboveThemMoveThem) {
  write_turned_lamp();
  // A quarter turn about y, and a shift: (x, y, z) to (z + 1, y + 2, -x).
  const std::string moved =
      "transform: [{rotate: {axis: [0, 1, 0], degrees: 90}}, {translate: [1, 2, 0]}], group: [{light: ";
  const CompiledScene compiled = compile(
      test::load_yaml(kFloor + "scene:\n" + kThings + "  - {" + moved +
                      "{position: [1, 2, 3], ies: turned.ies, direction: [0, -1, 1], zero: [1, 0, 0]}}]}\n"));
  ASSERT_EQ(compiled.scene.lights.size(), 1u);
  const Light& light = compiled.scene.lights[0];
  const auto near = [](const Vec3& a, const Vec3& b) { return glm::length(a - b) < 1e-12; };
  EXPECT_TRUE(near(light.position, {4, 4, -1}));
  EXPECT_TRUE(near(light.direction, normalized(Vec3(1, -1, 0))));
  EXPECT_TRUE(near(light.zero, {0, 0, -1}));
  EXPECT_EQ(light.moving, kNone);
}

TEST(TreeLights, AnimationMovesThemInEveryModelAndWhileTheShutterIsOpen) {
  // In frame 2 the light has gone half of its way: as if it stood there.
  const std::string here = "{position: [1.5, 2, 1.5], falloff: true, color: 5}";
  const std::string way =
      "  - {transform: {translate: {0: [0, 0, 0], 4: [1, 0, 0]}}, light: {position: [1, 2, 1.5], "
      "falloff: true, color: 5}}\n";
  for (const LightingModel model :
       {LightingModel::phong, LightingModel::whitted, LightingModel::thesis, LightingModel::path}) {
    EXPECT_EQ(render(kFloor + "frames: [0, 4]\nscene:\n" + kThings + way, model, 2),
              render(kFloor + "frames: [0, 4]\nlights: [" + here + "]\nscene:\n" + kThings, model, 2));
    EXPECT_NE(render(kFloor + "frames: [0, 4]\nscene:\n" + kThings + way, model, 2),
              render(kFloor + "frames: [0, 4]\nscene:\n" + kThings + way, model, 2, 1));
  }
}

TEST(TreeLights, AClusterTakesItsLightsAlongHoweverOftenItIsUsed) {
  std::string text = kFloor +
                     "objects: {lamp: [{light: {position: [0, 1, 0], falloff: true}}, {material: m, sphere: "
                     "{center: [0, 1.5, 0], radius: 0.1}}]}\nscene:\n" +
                     kThings;
  for (int i = 0; i < 5; ++i)
    text += fmt::format("  - {{use: lamp, transform: {{translate: [{}, 0, 0]}}}}\n", i);
  const CompiledScene compiled = compile(test::load_yaml(text));
  ASSERT_EQ(compiled.scene.lights.size(), 5u);
  for (int i = 0; i < 5; ++i)
    EXPECT_EQ(compiled.scene.lights[static_cast<size_t>(i)].position, Vec3(i, 1, 0));
}

TEST(TreeLights, AScaleMovesThemAndChangesNothingElse) {
  // A light's strength is its own: 2 away, a bulb of intensity 4 gives 1 whatever scale brought it there; a
  // white surface shows that over π.
  for (const std::string& node : std::vector<std::string>{
           "light: {position: [0, 2, 0], falloff: true, color: 4}",
           "transform: {scale: 10}, light: {position: [0, 0.2, 0], falloff: true, color: 4}",
           "transform: {scale: [1, -0.5, 3]}, light: {position: [0, -4, 0], falloff: true, color: 4}"}) {
    Probe probe(
        "materials: {m: {lambertian: 1}}\nscene:\n  - {material: m, polygon: {points: "
        "[[-9,0,-9],[-9,0,9],[9,0,"
        "9],[9,0,-9]]}}\n  - {" +
        node + "}\n");
    probe.settings.max_depth = 1;
    probe.settings.lighting = LightingModel::phong;
    EXPECT_NEAR(probe.mean(Vec3(0, 1, 0), Vec3(0, -1, 0), 1).x, 1 / pi, 1e-12) << node;
  }
}

TEST(TreeLights, AMirrorImageOfALampHasTheMirrorImageOfItsLight) {
  const Probe probe("scene:\n  - {light: " + kinds()[3] + "}\n  - {transform: {scale: [-1, 1, 1]}, light: " +
                    kinds()[3] + "}\n  - {sphere: {center: [0, 0, 0], radius: 0.1}}\n");
  const Scene& scene = probe.compiled.scene;
  std::mt19937 random(4);
  for (int i = 0; i < 200; ++i) {
    const Vec3 p = test::random_point(random, 3);
    const Color a = sample_light(scene, probe.pose, scene.lights[0], p, {}).incident,
                b = sample_light(scene, probe.pose, scene.lights[1], {-p.x, p.y, p.z}, {}).incident;
    EXPECT_NEAR(a.x, b.x, 1e-9);
  }
}

TEST(TreeLights, ThereIsALimitOfAllCopies) {
  std::string text = test::view_text() + "objects:\n  a0: {light: {position: [0, 0, 0]}}\n";
  for (int i = 1; i <= 5; ++i) {
    text += fmt::format("  a{}: {{group: [", i);
    for (int k = 0; k < 10; ++k)
      text +=
          fmt::format("{}{{use: a{}, transform: {{translate: [{}, 0, 0]}}}}", k ? ", " : "", i - 1, k + 1);
    text += "]}\n";
  }
  const std::string error = test::error_of(text + "scene: [{use: a5}]\n");
  EXPECT_NE(error.find("scene.yaml:3:"), std::string::npos) << error;
  EXPECT_NE(error.find("more than 10000 lights"), std::string::npos) << error;
}

TEST(TreeLights, SpotsThatShinePastEverythingAreNamedOnce) {
  const std::string spot = "{light: {position: [0, 3, 0], direction: [0, 1, 0], angle: 20, color: 3}}";
  const std::string notes =
      test::notes_of(kFloor + "objects:\n  spot: " + spot + "\nscene:\n" + kThings +
                     "  - {use: spot}\n  - {use: spot, transform: {translate: [1, 0, 0]}}\n"
                     "  - {use: spot, transform: {rotate: {axis: [1, 0, 0], degrees: 180}}, visible: "
                     "{0: false, 3: true}}\n");
  EXPECT_NE(notes.find("scene.yaml:4:"), std::string::npos) << notes;
  EXPECT_NE(notes.find("the spot shines past everything at the first frame (2 copies of it do)"),
            std::string::npos)
      << notes;
  EXPECT_EQ(std::count(notes.begin(), notes.end(), '\n'), 1) << notes;
  // Turned round by the tree it shines at the scene.
  EXPECT_EQ(
      test::notes_of(kFloor + "scene:\n" + kThings +
                     "  - {transform: [{translate: [0, -3, 0]}, {rotate: {axis: [1, 0, 0], degrees: 180}}, "
                     "{translate: [0, 3, 0]}], group: [" +
                     spot + "]}\n"),
      "");
  EXPECT_NE(
      test::notes_of(kFloor + "scene:\n" + kThings + "  - {material: m, light: {position: [0, 2, 0]}}\n")
          .find("a light has no material"),
      std::string::npos);
}

/// What a viewer at `from` sees of a small lamp at the origin.
double seen(const std::string& luminaire, const std::string& node, const Vec3& from) {
  Probe probe("materials: {lamp: {luminaire: " + luminaire + "}}\nscene: [{" + node +
              ", group: [{material: lamp, sphere: {center: [0, 0, 0], radius: 0.1}}]}]\n");
  probe.settings.lighting = LightingModel::path;
  return probe.mean(from, -from, 1).x;
}

TEST(TreeLights, LuminairesHaveDiagramsThatTurnWithThem) {
  // Table I: "light attributes describe the intensity of the light, its goniometric diagram". 10 at the axis,
  // 5 at 90 degrees, 2 behind: relative to the largest.
  test::write_temporary("lamp.ies", "TILT=NONE\n1 1 1 3 1 1 1 0 0 0\n1 1 1\n0 90 180\n0\n10 5 2\n");
  const std::string plain = "{emission: 3, ies: lamp.ies}",
                    aside = "{emission: 3, ies: lamp.ies, direction: [1, 0, 0]}";
  const std::string still = "name: a", turned = "transform: {rotate: {axis: [0, 0, 1], degrees: 90}}";
  EXPECT_NEAR(seen(plain, still, {0, -3, 0}), 3, 1e-12);
  EXPECT_NEAR(seen(plain, still, {0, 0, 3}), 1.5, 1e-12);
  EXPECT_NEAR(seen(plain, still, {0, 3, 0}), 0.6, 1e-12);
  EXPECT_NEAR(seen(aside, still, {3, 0, 0}), 3, 1e-12);
  // Turned from x to y, down becomes +x, and x becomes y.
  EXPECT_NEAR(seen(plain, turned, {3, 0, 0}), 3, 1e-9);
  EXPECT_NEAR(seen(aside, turned, {0, 3, 0}), 3, 1e-9);
}

TEST(TreeLights, DiagramsOfLuminairesLightInEveryModel) {
  // A small square lamp 3 above a floor that looks up at it: straight below the diagram says 1, at the side
  // it says what its cosine does.
  test::write_temporary("cosine.ies", "TILT=NONE\n1 1 1 4 1 1 1 0 0 0\n1 1 1\n0 60 90 180\n0\n100 50 0 0\n");
  const auto on_floor = [](const std::string& luminaire, double x, LightingModel model) {
    Probe probe(
        "materials: {m: {lambertian: 1}, lamp: {luminaire: " + luminaire +
        "}}\nscene:\n  - {material: m, polygon: {points: [[-9,0,-9],[-9,0,9],[9,0,9],[9,0,-9]]}}\n"
        "  - {material: lamp, polygon: {points: [[-0.1, 3, -0.1], [0.1, 3, -0.1], [0.1, 3, 0.1], [-0.1, 3, "
        "0.1]]}}\n");
    probe.settings.lighting = model;
    probe.settings.max_depth = 2;
    return probe.mean(Vec3(x, 1, 0), Vec3(0, -1, 0), 2048).x;
  };
  const double aside = 3 * std::sqrt(3.0);  // seen under 60 degrees
  for (const LightingModel model : {LightingModel::phong, LightingModel::whitted, LightingModel::path}) {
    const double below =
        on_floor("{emission: 50, ies: cosine.ies}", 0, model) / on_floor("{emission: 50}", 0, model);
    const double there =
        on_floor("{emission: 50, ies: cosine.ies}", aside, model) / on_floor("{emission: 50}", aside, model);
    EXPECT_NEAR(below, 1, 0.02);
    EXPECT_NEAR(there, 0.5, 0.02);
  }
}

TEST(TreeLights, WhatCannotBeMeantIsRefused) {
  const auto error = [](const std::string& luminaire) {
    return test::error_of(test::view_text() + "materials: {l: {luminaire: " + luminaire + "}}\nscene: []\n");
  };
  EXPECT_NE(error("{emission: 1, zero: [1, 0, 0]}").find("give `ies`, too"), std::string::npos);
  EXPECT_NE(error("{emission: 1, exponent: 3, ies: lamp.ies}").find("either `ies` or `exponent`"),
            std::string::npos);
  EXPECT_NE(error("{emission: 1, ies: none.ies}").find("scene.yaml:2:"), std::string::npos);
  test::write_temporary("dark.ies", "TILT=NONE\n1 1 1 2 1 1 1 0 0 0\n1 1 1\n0 180\n0\n0 0\n");
  EXPECT_NE(error("{emission: 1, ies: dark.ies}").find("no intensity above 0"), std::string::npos);
  EXPECT_NE(test::error_of(test::view_text() + "scene: [{light: {color: 1}}]\n").find("scene.yaml:2:"),
            std::string::npos);
}

}  // namespace
}  // namespace rayfarm
