// Spectra as straight lines between nodes (Shirley, Sung and Brown 1991, section 2.1): in scenes, in the
// general model, and against sums worked out here.
#include <cstring>

#include "common/lighting/renderer.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

RenderSettings settings_of(ColourModel model, std::vector<double> nodes = {}) {
  RenderSettings settings;
  settings.width_px = settings.height_px = 1;
  settings.crop = {0, 0, 1, 1};
  settings.colour = model;
  settings.colour_nodes_nm = std::move(nodes);
  settings.pixel_format = PixelFormat::float32;
  return settings;
}

/// The one pixel of a scene.
Color render_pixel(const CompiledScene& compiled, const RenderSettings& settings) {
  const RenderedPixels rendered = Renderer(compiled.scene, settings).render(0, settings.crop, [] {});
  std::array<float, 3> values;
  EXPECT_EQ(rendered.pixels.size(), sizeof values);
  std::memcpy(values.data(), rendered.pixels.data(), sizeof values);
  return {static_cast<double>(values[0]), static_cast<double>(values[1]), static_cast<double>(values[2])};
}

void expect_near(const Color& a, const Color& b, double tolerance) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance) << "channel " << c;
}

TEST(Spectrum, IsAStraightLineBetweenItsNodesAndConstantBeyond) {
  const std::vector<SpectrumNode> spectrum{{400, 1}, {500, 3}, {510, 0}};
  EXPECT_EQ(eval_spectrum(spectrum, 300), 1);
  EXPECT_EQ(eval_spectrum(spectrum, 425), 1.5);
  EXPECT_EQ(eval_spectrum(spectrum, 500), 3);
  EXPECT_NEAR(eval_spectrum(spectrum, 509), 0.3, 1e-12);
  EXPECT_EQ(eval_spectrum(spectrum, 900), 0);
  expect_near(rgb_of(std::vector<SpectrumNode>{{550, 0.7}}), Color(0.7), 1e-12);
}

TEST(Spectrum, AnyNodesThatTellColoursApartBringRgbBack) {
  for (const std::vector<double>& nodes :
       {even_nodes(4), even_nodes(37), even_nodes(500), {450, 550, 620}, {380, 381, 530, 531.5, 700}}) {
    EXPECT_TRUE(are_colour_nodes(nodes));
    for (const Color& rgb : {Color(1), Color(1, 0, 0), Color(0.2, 0.7, 0.3)}) {
      Color back(0);
      for (const ColourPass& pass : make_passes(nodes, false))
        back += pass.rgb_from_channels * (pass.channels_from_rgb * rgb);
      expect_near(back, rgb, 1e-9);
    }
  }
  for (const std::vector<double>& nodes : {std::vector<double>{},
                                           {450, 620},
                                           {400, 410, 420, 430},
                                           {450, 620, 550},
                                           {450, 550, 550, 620},
                                           {379, 550, 620},
                                           {450, 550, 731},
                                           {450, NAN, 620},
                                           even_nodes(501)})
    EXPECT_FALSE(are_colour_nodes(nodes)) << nodes.size();
}

// Section 2.1: "When two colors were combined by an operation, a new color with possibly more nodes was
// generated." A wall of one spectrum under a lamp of another, at right angles: the picture is the product at
// all nodes of both, integrated. No set of 20 even nodes knows this lamp's line.
TEST(GeneralSpectra, ProductsHaveTheNodesOfBothColours) {
  const std::vector<SpectrumNode> lamp{{400, 0.5}, {544, 0.5}, {545.5, 9}, {547, 0.5}, {700, 2}},
      wall{{430, 0.1}, {545, 0.8}, {600, 0.3}};
  const CompiledScene compiled = compile(test::load_yaml(R"(
view: {location: [0, 0, 5], look_at: [0, 0, 0], field_of_view: 1}
lights: [{direction: [0, 0, -1], color: {spectrum: [[400, 0.5], [544, 0.5], [545.5, 9], [547, 0.5], [700, 2]]}}]
materials: {wall: {lambertian: {spectrum: [[430, 0.1], [545, 0.8], [600, 0.3]]}}}
scene: [{material: wall, polygon: {points: [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]}}]
)"));
  const RenderSettings settings = settings_of(ColourModel::spectral);
  const std::vector<double> nodes = colour_nodes(compiled.scene, settings);
  for (const std::vector<SpectrumNode>& spectrum : {lamp, wall})
    for (const SpectrumNode& node : spectrum)
      EXPECT_NE(std::find(nodes.begin(), nodes.end(), node.wavelength_nm), nodes.end()) << node.wavelength_nm;
  EXPECT_EQ(nodes.size(), 14u);  // those 8, the ends, and the corners of RGB colours
  std::vector<SpectrumNode> product;
  for (const double nm : nodes) product.push_back({nm, eval_spectrum(lamp, nm) * eval_spectrum(wall, nm)});
  const Color general = render_pixel(compiled, settings);
  expect_near(general, rgb_of(product), 1e-6);
  // Many even nodes come near to it, few don't.
  const auto error = [&](const RenderSettings& other) {
    return max_magnitude(render_pixel(compiled, other) - general);
  };
  EXPECT_LT(error(settings_of(ColourModel::spectral, even_nodes(500))), 0.01);
  EXPECT_GT(error(settings_of(ColourModel::spectral20)), 0.02);
  EXPECT_GT(error(settings_of(ColourModel::meyer4)), 0.02);
}

TEST(GeneralSpectra, HaveTheNodesOfMetalsAndCountCloseOnesOnce) {
  const CompiledScene compiled = compile(test::load_yaml(
      test::view_text() +
      "materials: {m: {conductor: copper}, n: {lambertian: {spectrum: [[476.8, 0.1], [477.2, 0.2]]}}}\n"
      "scene: []\n"));
  const std::vector<double> nodes = colour_nodes(compiled.scene, settings_of(ColourModel::spectral));
  EXPECT_NE(std::find(nodes.begin(), nodes.end(), 652.5), nodes.end());
  for (size_t i = 1; i < nodes.size(); ++i) EXPECT_GE(nodes[i], nodes[i - 1] + 0.5);
  EXPECT_TRUE(are_colour_nodes(nodes));
}

TEST(SceneSpectra, StandWhereverTheSceneHasAColour) {
  const std::string spectrum = "{spectrum: [[450, 0.2], [550, 0.4]]}";
  const CompiledScene compiled = compile(test::load_yaml(
      "view: {location: [0, 0, 5], look_at: [0, 0, 0]}\nbackground: " + spectrum + "\nambient: " + spectrum +
      "\nlights: [{position: [0, 0, 1]}, {position: [0, 0, 9], color: " + spectrum +
      ", intensity: 10}]\nmaterials:\n" + "  a: {color: " + spectrum + "}\n  b: {translucent: {front: " +
      spectrum + ", through: " + spectrum + "}}\n  c: {dielectric: {index: 1.5, filter: " + spectrum +
      "}}\n  d: {luminaire: {emission: " + spectrum + "}}\n  e: {conductor: {n: " + spectrum +
      ", k: [3, 2, 1]}}\nscene: []\n"));
  const ColourPass pass = make_passes(std::vector<double>{450, 550, 620}, false).front();
  const ColouredScene coloured(compiled.scene, pass);
  const Scene& scene = coloured.scene();
  const Color expected(0.2, 0.4, 0.4);
  const auto of = [&](size_t i) -> const Material& { return scene.materials[i]; };
  for (const Color& c :
       {scene.head().background, scene.head().ambient, scene.lights[1].color / 10.0, of(1).color, of(2).color,
        of(2).back, of(2).through, of(3).filter, of(4).emission, of(5).n})
    expect_near(c, expected, 1e-12);
  EXPECT_EQ(scene.lights[0].color, pass.channels_from_rgb * Color(1));
  // Three numbers are the constants at 630, 532 and 465 nm.
  expect_near(of(5).k, {1, 2 + 18.0 / 98, 2 + 88.0 / 98}, 1e-12);
}

TEST(SceneSpectra, OfLightsInObjectsAreThoseOfEachCopy) {
  const CompiledScene compiled = compile(test::load_yaml(test::view_text() + R"(
objects: {lamp: [{light: {position: [0, 0, 1], color: {spectrum: [[450, 0.2], [550, 0.4]]}}}]}
scene: [{light: {position: [0, 0, 2]}}, {use: lamp}, {use: lamp, transform: {translate: {0: [0, 0, 0], 4: [1, 0, 0]}}}]
)"));
  const ColouredScene coloured(compiled.scene,
                               make_passes(std::vector<double>{450, 550, 620}, false).front());
  ASSERT_EQ(coloured.scene().lights.size(), 3u);
  size_t spectral = 0;
  for (const Light& light : coloured.scene().lights) spectral += light.color == Color(0.2, 0.4, 0.4) ? 1 : 0;
  EXPECT_EQ(spectral, 2u);
}

TEST(SceneSpectra, OfRgbAreTheirColoursAsFarAsRec709HasThem) {
  const CompiledScene compiled = compile(test::load_yaml(test::view_text() + R"(
materials:
  red: {lambertian: {spectrum: [[599, 0], [600, 1]]}}
  orange: {lambertian: {spectrum: [[579, 0], [580, 1]]}}
  scaled: {luminaire: {emission: {spectrum: [[500, 2]], scale: 3}}}
scene: []
)"));
  EXPECT_EQ(compiled.scene.materials[1].color.y, 0);
  EXPECT_EQ(compiled.scene.materials[2].color.x, 1);  // 1.1, but no more comes back than comes in
  expect_near(compiled.scene.materials[3].emission, Color(6), 1e-12);
}

TEST(SceneSpectra, ErrorsHaveTheirPlace) {
  const auto error = [](const std::string& material) {
    return test::error_of("view: {location: [0, 0, 5], look_at: [0, 0, 0]}\nmaterials: {m: " + material +
                          "}\nscene: []\n");
  };
  const auto expect_says = [](const std::string& message, const char* what) {
    EXPECT_NE(message.find(what), std::string::npos) << message;
    EXPECT_NE(message.find("scene.yaml:2:"), std::string::npos) << message;
  };
  expect_says(error("{color: {spectrum: [[500, 0.1], [500, 0.2]]}}"), "must rise");
  expect_says(error("{color: {spectrum: []}}"), "empty");
  expect_says(error("{color: {spectrum: [500, 0.1]}}"), "[wavelength in nm, value]");
  expect_says(error("{color: {spectrum: [[500, -0.1]]}}"), "negative");
  expect_says(error("{color: {spectrum: [[0, 0.1]]}}"), "from 1 to 1e6");
  expect_says(error("{color: {spektrum: [[500, 0.1]]}}"), "did you mean 'spectrum'");
  expect_says(error("{lambertian: {spectrum: [[500, 0.2], [510, 1.1]]}}"), "1.1 times the light");
  EXPECT_EQ(error("{allow_impossible: true, lambertian: {spectrum: [[500, 0.2], [510, 1.1]]}}"), "");
  expect_says(error("{diffuse: 0.9, reflect: 0.2, color: {spectrum: [[500, 0.2], [510, 1]]}}"),
              "1.1 times the light");
  // A leaf reflects green and lets red through: together never more than came.
  EXPECT_EQ(error("{translucent: {front: {spectrum: [[540, 0.9], [560, 0.1]]}, through: {spectrum: [[540, "
                  "0.1], [560, 0.9]]}}}"),
            "");
  EXPECT_EQ(error("{translucent: {front: [1, 0, 0], back: 0, through: [0, 1, 1]}}"), "");
  EXPECT_NE(
      test::error_of(
          "view: {location: [0, 0, 5], look_at: [0, 0, 0]}\ntextures: {t: {kind: noise, first: {spectrum: "
          "[[500, 1]]}}}\nscene: []\n")
          .find("a spectrum can stand in materials"),
      std::string::npos);
}

}  // namespace
}  // namespace rayfarm
