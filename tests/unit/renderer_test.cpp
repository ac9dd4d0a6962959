// Rectangles of pixels: cuts, adaptive sampling, lens, shutter, colour passes.
#include "common/lighting/renderer.h"

#include <cstring>

#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

/// The pixels of a scene, row-major, linear.
std::vector<float> render_floats(const CompiledScene& compiled, RenderSettings settings,
                                 const PixelRect& rect, int frame = 0) {
  settings.pixel_format = PixelFormat::float32;
  const RenderedPixels rendered = Renderer(compiled.scene, settings).render(frame, rect, [] {});
  std::vector<float> floats(rendered.pixels.size() / 4);
  std::memcpy(floats.data(), rendered.pixels.data(), rendered.pixels.size());
  return floats;
}

TEST(Render, AnyCutGivesTheSamePixelsInEveryModel) {
  const CompiledScene compiled = compile(test::load_yaml(std::string(R"(
view: {location: {0: [0, 0, 5], 1: [0.2, 0, 5]}, look_at: [0, 0, 0], lens: {radius: 0.1, focus: 5}}
background: 0.4
lights: [{position: [3, 4, 5], color: 0.8}]
)") + test::bodies_in_motion()));
  RenderSettings settings;
  settings.width_px = settings.height_px = 22;
  settings.crop = {0, 0, 22, 22};
  settings.samples = 5;
  settings.shutter = 0.5;
  for (const LightingModel model : {LightingModel::whitted, LightingModel::thesis, LightingModel::path})
    for (const ColourModel colour : {ColourModel::rgb, ColourModel::meyer4}) {
      settings.lighting = model;
      settings.colour = colour;
      settings.filter = colour == ColourModel::rgb ? FilterKind::mitchell : FilterKind::tent;
      const std::vector<float> whole = render_floats(compiled, settings, settings.crop);
      for (const PixelRect& rect :
           {PixelRect{0, 0, 7, 5}, PixelRect{7, 3, 22, 22}, PixelRect{13, 9, 14, 10}}) {
        const std::vector<float> part = render_floats(compiled, settings, rect);
        for (int y = rect.y0; y < rect.y1; ++y)
          for (int x = rect.x0; x < rect.x1; ++x)
            for (int c = 0; c < 3; ++c)
              ASSERT_EQ(part[static_cast<size_t>(((y - rect.y0) * rect.width() + x - rect.x0) * 3 + c)],
                        whole[static_cast<size_t>((y * 22 + x) * 3 + c)]);
      }
    }
}

/// Counts of the whole picture, and its first channel's values.
struct Picture {
  RayCounts counts;
  std::vector<float> floats;
};
Picture render_picture(const CompiledScene& compiled, RenderSettings settings, const PixelRect& rect,
                       int frame) {
  settings.pixel_format = PixelFormat::float32;
  const RenderedPixels rendered = Renderer(compiled.scene, settings).render(frame, rect, [] {});
  Picture picture{rendered.counts, std::vector<float>(rendered.pixels.size() / 4)};
  std::memcpy(picture.floats.data(), rendered.pixels.data(), rendered.pixels.size());
  return picture;
}

TEST(AdaptiveSampling, TakesMoreSamplesAtEdgesOnlyForAnyCut) {
  // A white disk before black: the first samples tell inside and outside, all samples what lies between.
  const CompiledScene compiled = compile(test::load_yaml(test::view_text() + R"(
ambient: 1
background: 0
materials: {white: {ambient: 1, diffuse: 0}}
scene: [{material: white, sphere: {center: [0, 0, 0], radius: 1.2}}]
)"));
  RenderSettings settings;
  settings.width_px = settings.height_px = 32;
  settings.crop = {0, 0, 32, 32};
  settings.samples = 16;
  settings.filter = FilterKind::mitchell;
  const Picture all = render_picture(compiled, settings, settings.crop, 0);
  settings.adaptive_contrast = 0.1;
  const Picture whole = render_picture(compiled, settings, settings.crop, 0);
  EXPECT_LT(whole.counts[RayKind::primary], 32u * 32u * 16u / 3);
  EXPECT_GT(whole.counts[RayKind::primary], 32u * 32u);
  // Where a pixel got all its samples it is what it would have been anyway; elsewhere the disk or nothing.
  size_t greys = 0;
  for (size_t i = 0; i < whole.floats.size(); i += 3) {
    if (whole.floats[i] != 0 && whole.floats[i] != 1) {
      ++greys;
      EXPECT_EQ(whole.floats[i], all.floats[i]);
    }
  }
  EXPECT_GT(greys, 40u);
  RayCounts sum;
  for (const PixelRect& rect : {PixelRect{0, 0, 9, 32}, PixelRect{9, 0, 32, 13}, PixelRect{9, 13, 32, 32}}) {
    const Picture part = render_picture(compiled, settings, rect, 0);
    sum += part.counts;
    for (int y = rect.y0; y < rect.y1; ++y)
      EXPECT_TRUE(std::equal(part.floats.begin() + (y - rect.y0) * rect.width() * 3,
                             part.floats.begin() + (y - rect.y0 + 1) * rect.width() * 3,
                             whole.floats.begin() + (y * 32 + rect.x0) * 3));
  }
  EXPECT_EQ(sum, whole.counts);
}

TEST(AdaptiveSampling, RaysToTheCentresOfSmallObjectsFindThem) {
  // Specks a third of a pixel wide that move over a plain: a single sample misses most of them in most
  // frames.
  for (const char* speck :
       {"sphere: {center: [0, 0, 0], radius: 0.02}",
        "polygon: {points: [[-0.015, -0.015, 0], [0.015, -0.015, 0], [0.015, 0.015, 0], [-0.015, 0.015, 0]]}",
        "cylinder: {base: [-0.02, 0, 0], top: [0.02, 0, 0], radius: 0.03}"}) {
    const CompiledScene compiled = compile(test::load_yaml(test::view_text() + R"(
frames: [0, 20]
ambient: 1
background: 0
materials: {white: {ambient: 1, diffuse: 0}}
scene:
  - {material: white, transform: {translate: {0: [-1.3, 0.11, 0], 20: [1.4, 0.9, 0]}}, )" +
                                                           std::string(speck) + "}\n"));
    RenderSettings settings;
    settings.width_px = settings.height_px = 32;
    settings.crop = {0, 0, 32, 32};
    int found = 0, found_by_one = 0;
    for (int frame = 0; frame <= 20; ++frame) {
      const auto has_light = [](const Picture& p) {
        return *std::max_element(p.floats.begin(), p.floats.end()) > 0;
      };
      settings.samples = 1;
      settings.adaptive_contrast = 0;
      found_by_one += has_light(render_picture(compiled, settings, settings.crop, frame)) ? 1 : 0;
      settings.samples = 64;
      settings.adaptive_contrast = 0.1;
      const Picture picture = render_picture(compiled, settings, settings.crop, frame);
      found += has_light(picture) ? 1 : 0;
      // Its pixels alone are sampled again, four of them at most and their neighbours.
      EXPECT_GT(picture.counts[RayKind::primary], 32u * 32u + 63u);
      EXPECT_LT(picture.counts[RayKind::primary], 32u * 32u + 16u * 64u);
    }
    EXPECT_EQ(found, 21) << speck;
    EXPECT_LT(found_by_one, 15) << speck;
  }
}

TEST(Render, ALensIsSharpWhereItIsFocused) {
  // Black and white halves: through a pinhole, and in focus, no pixel but the edge's is grey.
  const auto grey_pixels = [](const std::string& lens) {
    const CompiledScene compiled =
        compile(test::load_yaml("view: {location: [0, 0, 5], look_at: [0, 0, 0]" + lens + R"(}
ambient: 1
background: 1
materials: {black: {color: 0, ambient: 1}}
scene: [{material: black, polygon: {points: [[0, -9, 0], [9, -9, 0], [9, 9, 0], [0, 9, 0]]}}]
)"));
    RenderSettings settings;
    settings.width_px = settings.height_px = 40;
    settings.samples = 64;
    int grey = 0;
    const std::vector<float> row = render_floats(compiled, settings, {0, 20, 40, 21});
    for (size_t x = 0; x < 40; ++x) grey += row[3 * x] > 0.05 && row[3 * x] < 0.95 ? 1 : 0;
    return grey;
  };
  EXPECT_LE(grey_pixels(""), 1);
  EXPECT_LE(grey_pixels(", lens: {radius: 0.5, focus: 5}"), 1);
  // Focused at 2.5 the edge at 5 is blurred over 2 × 0.5 × (5 - 2.5) / 2.5 = 1 unit: 40 / 4.14 = 10 pixels.
  EXPECT_NEAR(grey_pixels(", lens: {radius: 0.5, focus: 2.5}"), 9, 2);
}

TEST(Render, MovingThingsAreBlurred) {
  // An edge moves 2 units to the right in a frame; the shutter is open for half of it: a ramp one unit wide.
  const CompiledScene compiled = compile(test::load_yaml(R"(
view: {location: [0, 0, 5], look_at: [0, 0, 0]}
background: 1
materials: {black: {color: 0, ambient: 1}}
scene: [{material: black, transform: {translate: {0: [0, 0, 0], 1: [2, 0, 0]}}, polygon: {points: [[0, -9, 0], [9, -9, 0], [9, 9, 0], [0, 9, 0]]}}]
)"));
  RenderSettings settings;
  settings.width_px = settings.height_px = 40;
  settings.samples = 64;
  settings.shutter = 0.5;
  const std::vector<float> row = render_floats(compiled, settings, {0, 20, 40, 21});
  const double unit_px = 40 / (2 * 5 * std::tan(22.5 * M_PI / 180));
  for (int x = 0; x < 40; ++x) {
    const double at = (x + 0.5 - 20) / unit_px;  // in units: white is seen until the edge has passed
    EXPECT_NEAR(row[static_cast<size_t>(3 * x)], std::clamp(1 - at, 0.0, 1.0), 0.06) << x;
  }
}

TEST(Render, FlatSpectraLookTheSameInEveryColourModel) {
  const CompiledScene compiled = compile(test::load_yaml(R"(
view: {location: [0, 0, 5], look_at: [0, 0, 0]}
background: [0.3, 0.5, 0.9]
lights: [{position: [3, 4, 5], color: [1, 0.9, 0.8]}]
materials: {m: {color: [0.7, 0.5, 0.3]}}
scene: [{material: m, sphere: {center: [0, 0, 0], radius: 1}}]
)"));
  RenderSettings settings;
  settings.width_px = settings.height_px = 24;
  const std::vector<float> rgb = render_floats(compiled, settings, {0, 0, 24, 24});
  for (const ColourModel colour : {ColourModel::meyer4, ColourModel::spectral20}) {
    settings.colour = colour;
    const std::vector<float> spectral = render_floats(compiled, settings, {0, 0, 24, 24});
    // The background is exact; a light on a surface multiplies spectra, which is not what RGB does, but near
    // it.
    for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(spectral[c], rgb[c], 1e-6);
    for (size_t i = 0; i < rgb.size(); ++i) EXPECT_NEAR(spectral[i], rgb[i], 0.03);
  }
}

}  // namespace
}  // namespace rayfarm
