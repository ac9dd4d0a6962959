// Mixes of materials by a texture (Shirley, Sung and Brown 1991, section 4: tiles of marble and steel, and
// dust that covers both): values that can be worked out by hand.
#include "common/compile/darkness.h"
#include "tests/unit/probe.h"

namespace rayfarm {
namespace {

/// A wall of `mix` in light of 1 from everywhere; the ambient light is also 1.
std::string wall(const std::string& textures, const std::string& materials) {
  return "background: 1\ntextures: {" + textures + "}\nmaterials:\n" + materials +
         "scene: [{material: m, polygon: {points: [[-9, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]]}}]\n";
}

TEST(Mix, TilesAreOneMaterialOrTheOther) {
  Probe probe(wall("tiles: {kind: checker, first: 0, second: 1}",
                   "  marble: {lambertian: 0.3}\n  steel: {lambertian: [0.6, 0.7, 0.8]}\n"
                   "  m: {mix: {a: marble, b: steel, by: tiles}}\n"));
  expect_color(probe.mean(Vec3(0.5, 0.5, 5), Vec3(0, 0, -1), 8), Color(0.3));
  expect_color(probe.mean(Vec3(1.5, 0.5, 5), Vec3(0, 0, -1), 8), Color(0.6, 0.7, 0.8));
}

// In between the light is the mean of both materials', by weight: for a Lambertian of albedo a in light 1, a.
TEST(Mix, InBetweenShowsTheMeanOfBoth) {
  Probe probe(wall("grey: {kind: checker, first: 0.3, second: 0.3}",
                   "  a: {lambertian: 0.2}\n  b: {lambertian: 0.8}\n  m: {mix: {a: a, b: b, by: grey}}\n"));
  constexpr uint32_t kSamples = 4096;
  expect_color(probe.mean(Vec3(0.5, 0.5, 5), Vec3(0, 0, -1), kSamples), Color(0.7 * 0.2 + 0.3 * 0.8), 0.002);
}

TEST(Mix, ClassicalModelsChooseAsOften) {
  Probe probe(wall(
      "grey: {kind: checker, first: 0.25, second: 0.25}",
      "  a: {color: 1, ambient: 0.1, diffuse: 0}\n  b: {color: 0.5, ambient: 0.6, diffuse: 0, reflect: 0.5}\n"
      "  m: {mix: {a: a, b: b, by: grey}}\n"));
  for (const LightingModel model : {LightingModel::whitted, LightingModel::phong,
                                    LightingModel::torrance_sparrow, LightingModel::thesis}) {
    probe.settings.lighting = model;
    probe.settings.max_depth = 3;
    const bool is_local = model == LightingModel::phong || model == LightingModel::torrance_sparrow;
    const double ambient = model == LightingModel::thesis ? 0 : 0.75 * 0.1 + 0.25 * 0.3;
    expect_color(probe.mean(Vec3(0.5, 0.5, 5), Vec3(0, 0, -1), 4096),
                 Color(ambient + (is_local ? 0 : 0.25 * 0.5)), 0.002);
  }
}

TEST(Mix, MayBeOfMixes) {
  Probe probe(
      wall("half: {kind: checker, first: 0.5, second: 0.5}, fifth: {kind: checker, first: 0.2, second: 0.2}",
           "  a: {lambertian: 0.9}\n  b: {lambertian: 0.1}\n  c: {lambertian: [1, 0, 0]}\n"
           "  ab: {mix: {a: a, b: b, by: half}}\n  m: {mix: {a: ab, b: c, by: fifth}}\n"));
  const double of_ab = 0.8 * 0.5;
  expect_color(probe.mean(Vec3(0.5, 0.5, 5), Vec3(0, 0, -1), 8192), Color(of_ab + 0.2, of_ab, of_ab), 0.003);
}

TEST(Mix, PartsKeepTheirOwnTextures) {
  Probe probe(
      wall("tiles: {kind: checker, first: 0, second: 1}, paint: {kind: checker, first: 0.5, second: 0.25, "
           "scale: 4}",
           "  a: {lambertian: 0.8, texture: paint}\n  b: {lambertian: 0.1}\n  m: {mix: {a: a, b: b, by: "
           "tiles}}\n"));
  expect_color(probe.mean(Vec3(0.5, 0.5, 5), Vec3(0, 0, -1), 8), Color(0.4));
  expect_color(probe.mean(Vec3(4.5, 0.5, 5), Vec3(0, 0, -1), 8), Color(0.2));
}

// Glass under dust that lies nowhere is glass, inside and out: light goes in and comes out, and is absorbed.
TEST(Mix, GlassUnderNoDustIsGlass) {
  const auto ball = [](const char* material) {
    return std::string(
               "background: [0.2, 0.5, 0.9]\ntextures: {none: {kind: checker, first: 0, second: "
               "0}}\nmaterials:\n"
               "  glass: {dielectric: {index: 1.5, filter: [0.9, 0.7, 0.5]}}\n  dust: {lambertian: 0.5}\n"
               "  dusty: {mix: {a: glass, b: dust, by: none}}\nscene: [{sphere: {center: [0, 0, 0], radius: "
               "1}, "
               "material: ") +
           material + "}]\n";
  };
  Probe clean(ball("glass")), dusty(ball("dusty"));
  for (const double x : {0.0, 0.3, 0.8}) {
    const Color a = clean.mean(Vec3(x, 0.1, 5), Vec3(0, 0, -1), 64),
                b = dusty.mean(Vec3(x, 0.1, 5), Vec3(0, 0, -1), 64);
    EXPECT_EQ(a, b);
  }
}

TEST(Mix, WhatLightsTheSceneIsSeenInItsParts) {
  const auto compiled = [](const char* ambient) {
    return compile(test::load_yaml(
        test::view_text() + "textures: {t: {kind: noise}}\nmaterials:\n  a: {color: 1, ambient: " + ambient +
        "}\n  b: {color: 1, ambient: 0}\n  m: {mix: {a: a, b: b, by: t}}\n"
        "scene: [{material: m, sphere: {center: [0, 0, 0], radius: 1}}]\n"));
  };
  EXPECT_TRUE(is_dark(compiled("0").scene, {}));
  EXPECT_FALSE(is_dark(compiled("0.1").scene, {}));
}

TEST(Mix, ErrorsHaveTheirPlace) {
  const auto error = [](const std::string& materials) {
    return test::error_of(test::view_text() +
                          "textures: {t: {kind: noise}}\nmaterials:\n  a: {lambertian: 0.5}\n" + materials +
                          "\nscene: []\n");
  };
  const auto expect_says = [](const std::string& message, const char* what) {
    EXPECT_NE(message.find(what), std::string::npos) << message;
    EXPECT_NE(message.find("scene.yaml:5:"), std::string::npos) << message;
  };
  expect_says(error("  m: {mix: {a: a, b: later, by: t}}\n  later: {lambertian: 0}"), "stand above it");
  expect_says(error("  m: {mix: {a: a, b: m, by: t}}"), "unknown material 'm'");
  expect_says(error("  m: {mix: {a: a, b: a, by: u}}"), "unknown texture 'u'");
  expect_says(error("  m: {mix: {a: a, by: t}}"), "needs `a`, `b` and `by`");
  expect_says(error("  m: {mix: {a: a, b: a, by: t}, texture: t}"), "nothing but its parts");
  const std::string lamp = error("  lamp: {luminaire: {emission: 1}}\n  m: {mix: {a: a, b: lamp, by: t}}");
  EXPECT_NE(lamp.find("'lamp' is a luminaire"), std::string::npos) << lamp;
  const std::string two = error(
      "  g: {dielectric: glass}\n  w: {dielectric: water}\n  gd: {mix: {a: g, b: a, by: t}}\n"
      "  m: {mix: {a: gd, b: w, by: t}}");
  EXPECT_NE(two.find("two dielectrics"), std::string::npos) << two;
  EXPECT_EQ(
      error("  g: {dielectric: glass}\n  gd: {mix: {a: g, b: a, by: t}}\n  m: {mix: {a: gd, b: g, by: t}}"),
      "");
}

TEST(Mix, OfAMaterialWithItselfIsNoted) {
  const SceneDescription scene = test::load_yaml(test::view_text() +
                                                 "textures: {t: {kind: noise}}\nmaterials: {a: {lambertian: "
                                                 "1}, m: {mix: {a: a, b: a, by: t}}}\nscene: []\n");
  ASSERT_EQ(scene.notes.lines().size(), 1u);
  EXPECT_NE(scene.notes.lines()[0].find("with itself"), std::string::npos);
}

}  // namespace
}  // namespace rayfarm
