// Principled materials in scenes: what textures vary, opacity in every model, errors and notes.
#include "common/lighting/principled_surface.h"
#include "common/lighting/textured.h"
#include "tests/unit/damaged_scene.h"
#include "tests/unit/probe.h"

namespace rayfarm {
namespace {

/// A wall of material m, whose (u, v) go from 0 to 1 along x and y.
std::string square_of(const std::string& textures, const std::string& principled) {
  return "background: 1\ntextures: {" + textures + "}\nmaterials: {m: {principled: {" + principled +
         "}}}\nscene: [{material: m, polygon: {points: [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]}}]\n";
}

/// A texture of one colour, which no file is read for.
std::string one_colour(const std::string& name, const std::string& color) {
  return name + ": {kind: checker, first: " + color + ", second: " + color + "}";
}

struct Wall {
  explicit Wall(const std::string& text)
      : compiled(compile(test::load_yaml(test::view_text() + text))),
        frame_pose(compiled.scene),
        pose(frame_pose.at(0)) {}
  /// At (x, y) of the wall, seen from the front.
  PrincipledPoint at(double x, double y, double side = 1) {
    const Ray ray{Vec3(x, y, 3 * side), Vec3(0, 0, -side)};
    const Hit hit = closest_hit(compiled.scene, pose, ray);
    EXPECT_TRUE(hit.is_hit());
    surface = eval_surface(compiled.scene, pose, ray, hit);
    PrincipledPoint point;
    material = textured(compiled.scene, pose, ray, hit, 0, 0, surface, point);
    return point;
  }
  CompiledScene compiled;
  FrameState frame_pose;
  Pose pose;
  Surface surface;
  Material material;
};

TEST(PrincipledTextures, EachParameterTakesOneAndItsChannel) {
  const std::string texture = one_colour("t", "[0.2, 0.4, 0.6]");
  const auto at = [&](const std::string& key, const std::string& channel) {
    return Wall(square_of(texture, (key == "transmission" || key == "clearcoat"
                                        ? ""
                                        : "transmission: 0.5, clearcoat: 0.5, ") +
                                       key + ": {texture: t, channel: " + channel + ", factor: 0.5}"))
        .at(0.5, 0.5);
  };
  EXPECT_NEAR(at("metallic", "r").metallic, 0.1, 1e-12);
  EXPECT_NEAR(at("metallic", "b").metallic, 0.3, 1e-12);
  EXPECT_NEAR(at("roughness", "g").roughness, 0.2, 1e-12);
  EXPECT_NEAR(at("specular", "luminance").specular, 0.5 * luminance(Color(0.2, 0.4, 0.6)), 1e-12);
  EXPECT_NEAR(at("transmission", "r").transmission, 0.1, 1e-12);
  EXPECT_NEAR(at("clearcoat", "g").coat, 0.2, 1e-12);
  EXPECT_NEAR(at("clearcoat_roughness", "b").coat_roughness, 0.3, 1e-12);
  const PrincipledPoint colored =
      Wall(square_of(texture, "base_color: {texture: t, factor: [1, 0.5, 0.25]}, specular_color: t"))
          .at(0.5, 0.5);
  expect_color(colored.base, Color(0.2, 0.2, 0.15));
  expect_color(colored.specular_color, Color(0.2, 0.4, 0.6));
  Wall lamp(square_of(texture, "emission: t, emission_strength: 10"));
  lamp.at(0.5, 0.5);
  expect_color(lamp.material.emission, Color(2, 4, 6));
}

// KHR_texture_transform: offset, rotation and scale of each use.
TEST(PrincipledTextures, EachUseHasATransform) {
  const std::string rows = "t: {kind: array, map: uv, size: [1, 2, 1], values: [0, 1], scale: 0.5}";
  const auto metallic = [&](const std::string& more, double x, double y) {
    return Wall(square_of(rows, "metallic: {texture: t" + more + "}")).at(x, y).metallic;
  };
  EXPECT_NEAR(metallic("", 0.3, 0.25), 0, 1e-9);
  EXPECT_NEAR(metallic("", 0.3, 0.75), 1, 1e-9);
  EXPECT_NEAR(metallic(", rotate: 90", 0.75, 0.3), 1, 1e-9);  // v is what u was
  EXPECT_NEAR(metallic(", rotate: 90", 0.25, 0.3), 0, 1e-9);
  EXPECT_NEAR(metallic(", scale: [1, -1], offset: [0, 1]", 0.3, 0.75), 0, 1e-9);
  EXPECT_NEAR(metallic(", scale: 2", 0.3, 0.875), 1, 1e-9);
}

/// An image of one pixel, whose bytes are these.
std::string write_pixel(const char* name, std::array<int, 3> rgb) {
  Image image{1, 1, {0, 0, 1, 1}, make_pixel_layout(PixelFormat::rgb8), {}};
  for (const int value : rgb) image.pixels.push_back(static_cast<std::byte>(value));
  write_image(test::write_temporary(name, ""), image, {});
  return name;
}

TEST(PrincipledTextures, MapsOfNormalsLeanAlongUAndV) {
  write_pixel("normal.png", {255, 128, 255});  // (1, 0, 1) / √2
  Wall wall(square_of("n: {kind: image, file: normal.png, encoding: linear}", "normal: n"));
  wall.at(0.5, 0.5);
  EXPECT_NEAR(glm::length(wall.surface.shading_normal - normalized(Vec3(1, 0, 1))), 0, 0.01);
  wall.at(0.5, 0.5, -1);  // from behind the same facet is seen from its back
  EXPECT_NEAR(glm::length(wall.surface.shading_normal + normalized(Vec3(1, 0, 1))), 0, 0.01);
  Wall half(square_of("n: {kind: image, file: normal.png, encoding: linear}",
                      "normal: {texture: n, strength: 0.5}"));
  half.at(0.5, 0.5);
  EXPECT_NEAR(glm::length(half.surface.shading_normal - normalized(Vec3(0.5, 0, 1))), 0, 0.01);
  // A coat has the surface's own normal, unless a map of its own says otherwise.
  Wall coated(square_of("n: {kind: image, file: normal.png, encoding: linear}", "normal: n, clearcoat: 1"));
  EXPECT_NEAR(glm::length(coated.at(0.5, 0.5).coat_normal - Vec3(0, 0, 1)), 0, 1e-9);
  Wall own(
      square_of("n: {kind: image, file: normal.png, encoding: linear}", "clearcoat_normal: n, clearcoat: 1"));
  EXPECT_NEAR(glm::length(own.at(0.5, 0.5).coat_normal - normalized(Vec3(1, 0, 1))), 0, 0.01);
}

// "sRGB textures decoded before they are filtered": the mean of black and white is half the light.
TEST(PrincipledTextures, ColoursAreDecodedBeforeTheyAreFiltered) {
  Image image{2, 1, {0, 0, 2, 1}, make_pixel_layout(PixelFormat::rgb8), {}};
  for (const int value : {0, 0, 0, 255, 255, 255}) image.pixels.push_back(static_cast<std::byte>(value));
  write_image(test::write_temporary("pair.png", ""), image, {});
  Wall wall(square_of("t: {kind: image, file: pair.png}", "base_color: t"));
  expect_color(wall.at(0.5, 0.5).base, Color(0.5), 1e-3);
  const std::string text = test::view_text() + square_of("t: {kind: image, file: pair.png}", "roughness: t");
  EXPECT_NE(test::notes_of(text).find("encoding: linear"), std::string::npos);
}

/// A file of these bytes.
void write_png_bytes(const char* name, std::initializer_list<int> bytes) {
  std::string text;
  for (const int byte : bytes) text += static_cast<char>(byte);
  test::write_temporary(name, text);
}

// An image's colours do not fade with its alpha, which is a texture of its own; grey images are grey.
TEST(PrincipledTextures, AlphaAndGreyImagesAreRead) {
  // One pixel each, as PNG: red 255, green 0, blue 255, alpha 64; and grey 51.
  write_png_bytes("leaf.png",
                  {137, 80,  78,  71,  13, 10,  26,  10, 0,   0,   0,   13,  73,  72,  68,  82, 0, 0,
                   0,   1,   0,   0,   0,  1,   8,   6,  0,   0,   0,   31,  21,  196, 137, 0,  0, 0,
                   13,  73,  68,  65,  84, 120, 156, 99, 248, 207, 240, 223, 1,   0,   6,   63, 2, 63,
                   129, 182, 216, 206, 0,  0,   0,   0,  73,  69,  78,  68,  174, 66,  96,  130});
  write_png_bytes("grey.png", {137, 80,  78,  71,  13, 10, 26, 10,  0,   0,  0,  13, 73,  72,  68,  82, 0,
                               0,   0,   1,   0,   0,  0,  1,  8,   0,   0,  0,  0,  58,  126, 155, 85, 0,
                               0,   0,   10,  73,  68, 65, 84, 120, 156, 99, 48, 6,  0,   0,   53,  0,  52,
                               202, 180, 153, 237, 0,  0,  0,  0,   73,  69, 78, 68, 174, 66,  96,  130});
  const std::string textures =
      "colour: {kind: image, file: leaf.png}, alpha: {kind: image, file: leaf.png, part: alpha}, grey: "
      "{kind: "
      "image, file: grey.png, encoding: linear}";
  Wall leaf(square_of(textures, "base_color: colour, roughness: grey"));
  const PrincipledPoint point = leaf.at(0.5, 0.5);
  expect_color(point.base, Color(1, 0, 1), 1e-3);
  EXPECT_NEAR(point.roughness, 51 / 255.0, 1e-3);
  Probe probe(square_of(textures, "base_color: 0, specular: 0, opacity: alpha"));
  expect_color(probe.mean(Vec3(0.5, 0.5, 5), Vec3(0, 0, -1), 1024), Color(1 - 64 / 255.0), 0.003);
}

/// What is seen behind a wall of this opacity in light of 1 from everywhere: the wall itself is black.
Color behind_black(const std::string& opacity, LightingModel model) {
  Probe probe(square_of(one_colour("t", "0.25"), "base_color: 0, specular: 0, " + opacity));
  probe.settings.lighting = model;
  return probe.mean(Vec3(0.5, 0.5, 5), Vec3(0, 0, -1), 1024);
}

// "opacity (MASK cutoff, BLEND stochastic-transparent in path; classical: transmitted)".
TEST(PrincipledOpacity, IsTheChanceToMeetTheSurface) {
  for (const LightingModel model :
       {LightingModel::path, LightingModel::whitted, LightingModel::phong, LightingModel::thesis}) {
    expect_color(behind_black("opacity: 0.25", model), Color(0.75), 0.005);
    expect_color(behind_black("opacity: {texture: t, channel: r, factor: 0.5}", model), Color(0.875), 0.005);
    expect_color(behind_black("opacity: t, cutoff: 0.5", model), Color(1));
    expect_color(behind_black("opacity: t, cutoff: 0.2", model), Color(0));
    expect_color(behind_black("one_sided: true", model), Color(0));
  }
}

TEST(PrincipledOpacity, BacksOfOneSidedSurfacesAreNotThere) {
  Probe probe(square_of(one_colour("t", "1"), "base_color: 0, specular: 0, one_sided: true"));
  expect_color(probe.mean(Vec3(0.5, 0.5, -5), Vec3(0, 0, 1), 8), Color(1));
}

// A white floor under a light that comes through a pane: less by the share that is there, in every model
// alike.
TEST(PrincipledOpacity, ShadowsLoseTheShareThatIsThere) {
  const auto floor = [](const std::string& opacity, LightingModel model) {
    Probe probe(
        "lights: [{direction: [0, 0, -1]}]\nmaterials: {pane: {principled: {base_color: 0, specular: 0, " +
        opacity +
        "}}}\nscene:\n  - polygon: {points: [[-9, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]]}\n"
        "  - {material: pane, polygon: {points: [[-1, -1, 2], [1, -1, 2], [1, 1, 2], [-1, 1, 2]]}}\n");
    probe.settings.lighting = model;
    return probe.mean(Vec3(0.1, 0.2, 1), Vec3(0, 0, -1), 8);
  };
  for (const LightingModel model : {LightingModel::path, LightingModel::whitted, LightingModel::phong}) {
    const Color without = floor("opacity: 0", model), all = floor("opacity: 1", model);
    expect_color(floor("opacity: 0.5", model), 0.5 * (without + all), 1e-9);
    expect_color(floor("opacity: 0.5, cutoff: 0.6", model), without, 1e-9);
    EXPECT_GT(without.x, all.x + 0.5);
  }
}

TEST(PrincipledLight, AnUnlitSurfaceShowsItsColourInEveryModel) {
  for (const LightingModel model : {LightingModel::path, LightingModel::whitted, LightingModel::phong})
    for (const double side : {1.0, -1.0}) {
      Probe probe(square_of(one_colour("t", "[0.2, 0.4, 0.6]"), "base_color: t, unlit: true"));
      probe.settings.lighting = model;
      expect_color(probe.mean(Vec3(0.5, 0.5, 5 * side), Vec3(0, 0, -side), 8), Color(0.2, 0.4, 0.6), 1e-9);
    }
}

// A lamp lights alike whether shadow rays are sent to it or chance finds it, as with a texture.
TEST(PrincipledLight, EmissionLightsWithAndWithoutATexture) {
  const auto lit = [](const std::string& emission, uint32_t samples) {
    Probe probe("textures: {" + one_colour("t", "1") +
                "}\nmaterials: {lamp: {principled: {base_color: 0, specular: 0, emission: " + emission +
                ", emission_strength: 3}}}\nscene:\n  - {material: lamp, polygon: {points: [[-2, -2, 3], "
                "[-2, 2, 3], [2, 2, 3], [2, "
                "-2, 3]]}}\n  - polygon: {points: [[-9, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]]}\n");
    return probe.mean(Vec3(0, 0, 1), Vec3(0, 0, -1), samples).x;
  };
  const double sent = lit("1", 1024);
  EXPECT_GT(sent, 0.3);
  EXPECT_NEAR(lit("t", 8192), sent, 0.02 * sent);
}

// KHR_materials_volume: what is left after the distance is the colour.
TEST(PrincipledVolume, LightTakesOnTheColourOnItsWay) {
  Probe probe(
      "background: 1\nmaterials: {m: {principled: {base_color: 1, transmission: 1, roughness: 0, ior: "
      "1.0001, "
      "attenuation_color: [0.5, 0.25, 1], attenuation_distance: 2}}}\n"
      "scene: [{material: m, sphere: {center: [0, 0, 0], radius: 2}}]\n");
  expect_color(probe.mean(Vec3(0, 0, 5), Vec3(0, 0, -1), 8), Color(0.25, 0.0625, 1), 1e-3);
}

TEST(PrincipledClassical, ModelsTakeTheNearestCoefficients) {
  Wall plastic(square_of(one_colour("t", "[0, 1, 0.5]"),
                         "base_color: [0.5, 0.25, 1], metallic: {texture: t, channel: b}"));
  const Material& m = plastic.compiled.scene.materials[1];
  // Of the texture's mean; metals of this roughness are mirrors by a quarter.
  const double reflected = 0.5 * 0.04 + 0.5 * luminance(Color(0.5, 0.25, 1)),
               sharp = 1 - smooth_step(0.1, 0.7, 0.5);
  EXPECT_NEAR(m.diffuse, 0.5 * 0.96 + 0.5 * (1 - sharp), 1e-9);
  EXPECT_NEAR(m.specular, reflected, 1e-9);
  EXPECT_NEAR(m.reflect, sharp * reflected, 1e-9);
  EXPECT_EQ(m.color, Color(0.5, 0.25, 1));
  EXPECT_EQ(m.ambient, 0);
}

TEST(PrincipledErrors, HaveTheirPlace) {
  const auto expect_error = [](const std::string& principled, const char* what) {
    const std::string message =
        test::error_of(test::view_text() + "textures: {t: {kind: noise}}\nmaterials:\n  m: {principled: {" +
                       principled + "}}\nscene: []\n");
    EXPECT_NE(message.find(what), std::string::npos) << principled << ": " << message;
    EXPECT_NE(message.find("scene.yaml:4:"), std::string::npos) << message;
  };
  expect_error("metallic: 1.5", "from 0 to 1");
  expect_error("roughness: -0.1", "from 0 to 1");
  expect_error("roughness: tt", "unknown texture 'tt'");
  expect_error("base_color: 1.2", "no more than 1");
  expect_error("rougness: 0.5", "roughness");
  expect_error("metallic: {texture: t, channel: a}", "luminance");
  expect_error("metallic: {texture: t, scale: 0}", "0 times");
  expect_error("normal: 0.5", "is a texture");
  expect_error("ior: 0.5", "from 1 to 100");
  expect_error("thin: true", "give `transmission`");
  expect_error("transmission: 1, thin: true, abbe: 30", "a sheet");
  expect_error("transmission: 1, attenuation_distance: 3", "give both");
  expect_error("clearcoat_roughness: 0.3", "`clearcoat`");
  expect_error("emission_strength: 3", "`emission`");
  expect_error("cutoff: 0.3", "`opacity`");
  expect_error("unlit: true, roughness: 0.3", "does nothing");
  const std::string texture = test::error_of(
      test::view_text() +
      "textures: {t: {kind: noise}}\nmaterials:\n  m: {principled: {}, texture: t}\nscene: []\n");
  EXPECT_NE(texture.find("base_color"), std::string::npos) << texture;
  const std::string mixed = test::error_of(
      test::view_text() +
      "textures: {t: {kind: noise}}\nmaterials:\n  a: {principled: {opacity: 0.5}}\n  b: {lambertian: 1}\n"
      "  m: {mix: {a: a, b: b, by: t}}\nscene: []\n");
  EXPECT_NE(mixed.find("holes"), std::string::npos) << mixed;
}

TEST(PrincipledErrors, DamagedBlocksAreRefused) {
  const CompiledScene compiled = compile(
      test::load_yaml(test::view_text() + square_of(one_colour("t", "1"), "base_color: t, opacity: 0.5")));
  test::expect_refusal<Material>(
      compiled, &Scene::materials, [](Material& m) { return m.principled == 0 && (m.principled = 7, true); },
      "parameters that are not there");
  test::expect_refusal<Material>(
      compiled, &Scene::materials,
      [](Material& m) { return m.principled == kNone && (m.is_pierced = 1, true); },
      "holes without parameters");
  test::expect_refusal<PrincipledMaterial>(
      compiled, &Scene::principled, [](PrincipledMaterial& m) { return m.sources[7].texture = 99, true; },
      "a texture that is not there");
  test::expect_refusal<PrincipledMaterial>(
      compiled, &Scene::principled, [](PrincipledMaterial& m) { return m.ior = 0, true; },
      "an index of nothing");
}

}  // namespace
}  // namespace rayfarm
