// Rays through the corners of subpixels (thesis 2.3.2, 3.4.1), and the directions that they share out.
#include <cstring>

#include "common/lighting/environment.h"
#include "common/lighting/renderer.h"
#include "common/scene/camera.h"
#include "tests/unit/probe.h"

namespace rayfarm {
namespace {

RenderSettings corner_settings(int width_px, int height_px, const Subpixels& subpixels) {
  RenderSettings settings;
  settings.width_px = width_px;
  settings.height_px = height_px;
  settings.crop = {0, 0, width_px, height_px};
  settings.sampling = SamplingPattern::corners;
  settings.subpixels = subpixels;
  settings.pixel_format = PixelFormat::float32;
  return settings;
}

/// The pixels of a rectangle, row-major, linear, and what was counted.
struct Rendered {
  std::vector<Color> pixels;
  RayCounts counts;
};
Rendered render(const CompiledScene& compiled, const RenderSettings& settings, const PixelRect& rect) {
  const RenderedPixels rendered = Renderer(compiled.scene, settings).render(0, rect, [] {});
  Rendered result{{}, rendered.counts};
  for (size_t i = 0; i < rendered.pixels.size(); i += 12) {
    std::array<float, 3> p;
    std::memcpy(p.data(), &rendered.pixels[i], 12);
    result.pixels.emplace_back(p[0], p[1], p[2]);
  }
  return result;
}

TEST(CornerSampling, CornersOfSubpixelsAreCountedOnceForAnyCut) {
  const CompiledScene compiled = compile(load_scene(std::string(RAYFARM_SOURCE) + "/scenes/primitives.yaml"));
  for (const LightingModel model : {LightingModel::whitted, LightingModel::thesis})
    for (const Subpixels subpixels : {Subpixels{1, 1}, Subpixels{3, 2}, Subpixels{4, 4}}) {
      RenderSettings settings = corner_settings(24, 18, subpixels);
      settings.lighting = model;
      const Rendered whole = render(compiled, settings, settings.crop);
      EXPECT_EQ(whole.counts[RayKind::primary], (24u * subpixels.columns + 1) * (18u * subpixels.rows + 1));
      RayCounts sum;
      for (const PixelRect& rect :
           {PixelRect{0, 0, 10, 18}, PixelRect{10, 0, 24, 7}, PixelRect{10, 7, 24, 18}}) {
        const Rendered part = render(compiled, settings, rect);
        sum += part.counts;
        for (int y = rect.y0; y < rect.y1; ++y)
          for (int x = rect.x0; x < rect.x1; ++x)
            ASSERT_EQ(part.pixels[static_cast<size_t>((y - rect.y0) * rect.width() + x - rect.x0)],
                      whole.pixels[static_cast<size_t>(y * 24 + x)]);
      }
      EXPECT_EQ(sum, whole.counts);
    }
}

// Thesis 3.4.1: "Rays are traced through the corners of a subpixel", and the filter "includes contributions
// from all incident rays traced within a pixel". Each ray is traced alone here.
TEST(CornerSampling, APixelIsTheMeanOfTheRaysThroughItsCorners) {
  Probe probe(std::string(kMixedRoom) + room("wall"));
  const Subpixels subpixels{3, 2};
  RenderSettings settings = corner_settings(7, 5, subpixels);
  settings.lighting = LightingModel::thesis;
  settings.diffuse_rays = 2;
  const Rendered rendered = render(probe.compiled, settings, settings.crop);
  const SamplingTables tables(settings, 0);
  const Camera camera = make_camera(probe.compiled.scene, 0, 7, 5);
  const std::unique_ptr<Integrator> integrator = make_integrator(settings.lighting);
  RayCounts counts;
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 7; ++x) {
      Color expected(0);
      for (uint32_t j = 0; j <= 2; ++j)
        for (uint32_t i = 0; i <= 3; ++i) {
          const SampleId id{x * 3 + static_cast<int>(i), y * 2 + static_cast<int>(j), 0};
          const Ray ray = camera.ray(x + i / 3.0, y + j / 2.0);
          Color color;
          integrator->trace({probe.compiled.scene, probe.pose, tables, camera.spread()},
                            RayPacket(std::span(&ray, 1)), std::span(&id, 1), counts, &color);
          expected += color / 12.0;
        }
      expect_color(rendered.pixels[static_cast<size_t>(y * 7 + x)], expected, 1e-6);
    }
}

// Thesis 3.4.1: N_RD (a + 1)(b + 1) directions from all the rays that pass through a pixel. One set for the
// whole picture (3.3: "calculated once at the start of the rendering session") is whole in every pixel: over
// a floor under a sky that depends on direction alone all pixels are the mean over the set.
TEST(CornerSampling, EveryPixelHasAWholeSetOfDirections) {
  std::mt19937 random(5);
  const std::string sky = test::write_environment(
      16, 8, [&](int, int) { return static_cast<float>(test::uniform(random, 0, 1)); });
  const CompiledScene compiled = compile(
      test::load_yaml("view: {location: [0, 5, 0], look_at: [0, 0, 0], up: [0, 0, -1], field_of_view: 40}\n"
                      "environment: {file: " +
                      sky + "}\n" + R"(
materials: {floor: {color: 1, ambient: 0, diffuse: 1}}
scene: [{material: floor, polygon: {points: [[-9, 0, -9], [-9, 0, 9], [9, 0, 9], [9, 0, -9]]}}]
)"));
  for (const Subpixels subpixels : {Subpixels{1, 1}, Subpixels{2, 2}, Subpixels{4, 4}, Subpixels{1, 3}})
    for (const uint32_t rays : {1u, 2u}) {
      RenderSettings settings = corner_settings(12, 9, subpixels);
      settings.lighting = LightingModel::thesis;
      settings.diffuse_rays = rays;
      settings.diffuse_set = DiffuseSet::fixed;
      const DiffuseDirections set(rays * subpixels.corners());
      const TurnedFrame frame(Vec3(0, 1, 0), 0);
      Color whole(0);
      for (const Vec3& direction : set.about_y())
        whole += eval_environment(compiled.scene, frame.to_world(direction)) /
                 static_cast<double>(set.about_y().size());
      for (const Color& pixel : render(compiled, settings, settings.crop).pixels)
        expect_color(pixel, whole, 1e-6);
      // A set that is turned from pixel to pixel sees another sky in each.
      settings.diffuse_set = DiffuseSet::turned;
      const std::vector<Color> turned = render(compiled, settings, settings.crop).pixels;
      EXPECT_NE(turned[0], turned[5]);
    }
}

// Thesis 3.5.1: oversampling of one, four and sixteen test 4, 9 and 25 directions for each pixel, and 50 with
// two diffuse rays for each incident ray.
TEST(CornerSampling, DirectionsOfThePlates) {
  RenderSettings settings;
  settings.lighting = LightingModel::thesis;
  settings.sampling = SamplingPattern::corners;
  const auto directions = [&](const Subpixels& subpixels) {
    settings.subpixels = subpixels;
    return diffuse_directions_of(settings);
  };
  EXPECT_EQ(directions({1, 1}), 4u);
  EXPECT_EQ(directions({2, 2}), 9u);
  EXPECT_EQ(directions({4, 4}), 25u);
  settings.diffuse_rays = 2;
  EXPECT_EQ(directions({4, 4}), 50u);
}

}  // namespace
}  // namespace rayfarm
