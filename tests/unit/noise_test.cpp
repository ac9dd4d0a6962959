// When a pixel needs no more samples, and pictures whose samples come in passes.
#include <limits>

#include "common/image/pixel_format.h"
#include "common/lighting/renderer.h"
#include "common/lighting/running_pixel.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

RunningPixel pixel_of(const std::vector<double>& greys) {
  RunningPixel pixel;
  for (const double grey : greys) pixel.add_with_squares(Color(grey));
  return pixel;
}

// n samples of which k are b and the others 0 scatter about k b / n with Σ (x - mean)² = b² k (n - k) / n:
// the standard error of their mean is b √(k (n - k) / (n² (n - 1))).
TEST(NoiseTargets, TheErrorOfTwoValuesIsTheAnalyticOne) {
  constexpr double kBright = 0.8, kExposure = 0.5;
  for (const int ones : {4, 16, 40}) {
    constexpr int kSamples = 64;
    std::vector<double> values;
    for (int i = 0; i < kSamples; ++i) values.push_back(i * ones % kSamples < ones ? kBright : 0);
    const RunningPixel pixel = pixel_of(values);
    const double n = kSamples, k = ones, mean = kExposure * kBright * k / n,
                 error = kExposure * kBright * std::sqrt(k * (n - k) / (n * n * (n - 1)));
    ASSERT_NEAR(kExposure * pixel.mean().y, mean, 1e-12);
    const double shown = (encode_srgb(mean + error) - encode_srgb(mean - error)) / 2;
    EXPECT_TRUE(NoiseTarget(shown * (1 + 1e-9), kExposure).is_met(pixel)) << ones;
    EXPECT_FALSE(NoiseTarget(shown * (1 - 1e-9), kExposure).is_met(pixel)) << ones;
  }
}

TEST(NoiseTargets, PixelsAreLookedAtAfterWholeBatches) {
  const NoiseTarget target(0.01, 1);
  for (const uint32_t n : {1u, NoiseTarget::kBatch - 1, NoiseTarget::kBatch + 1})
    EXPECT_FALSE(target.is_met(pixel_of(std::vector<double>(n, 0.3)))) << n;
  EXPECT_TRUE(target.is_met(pixel_of(std::vector<double>(NoiseTarget::kBatch, 0.3))));
  EXPECT_FALSE(target.is_met(RunningPixel()));
}

TEST(NoiseTargets, IsThatOfTheDisplay) {
  std::vector<double> bright, dark;
  for (int i = 0; i < 16; ++i) {
    bright.push_back(i % 2 ? 40 : 20);
    dark.push_back(i % 2 ? 0.01 : 0);
  }
  EXPECT_TRUE(NoiseTarget(1e-6, 1).is_met(pixel_of(bright))) << "white as any that a display shows";
  EXPECT_FALSE(NoiseTarget(1e-3, 1 / 64.0).is_met(pixel_of(bright)));
  // The mean 0.005 with an error of 0.0013: 0.005 in light, but 0.0125 of what is seen.
  EXPECT_FALSE(NoiseTarget(0.012, 1).is_met(pixel_of(dark)));
  EXPECT_TRUE(NoiseTarget(0.013, 1).is_met(pixel_of(dark)));
  RunningPixel red = pixel_of(std::vector<double>(16, 0.5));
  red.squares.x = 1;
  EXPECT_FALSE(NoiseTarget(0.01, 1).is_met(red)) << "one channel is enough";
  bright[3] = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(NoiseTarget(1, 1).is_met(pixel_of(bright)));
}

/// Soft shadows, a body in motion, glass, and much that is plain.
CompiledScene test_scene() {
  return compile(test::load_yaml(std::string(R"(
view: {location: {0: [0, 0, 5], 1: [0.2, 0, 5]}, look_at: [0, 0, 0]}
background: 0.4
)") + test::bodies_in_motion()));
}

RenderSettings path_settings(uint32_t samples) {
  RenderSettings settings = test::picture_settings(22, 22, LightingModel::path);
  settings.samples = samples;
  return settings;
}

std::vector<std::byte> row_of(const RenderedPixels& rendered, const PixelRect& rect, int x, int y,
                              int width) {
  const auto begin = rendered.pixels.begin() + 12 * ((y - rect.y0) * rect.width() + x - rect.x0);
  return {begin, begin + 12 * width};
}

TEST(NoiseTargets, AnyCutGivesTheSamePixelsFromFewerRays) {
  const CompiledScene compiled = test_scene();
  for (const double shutter : {0.0, 0.5}) {
    RenderSettings settings = path_settings(80);
    settings.shutter = shutter;
    settings.filter = shutter > 0 ? FilterKind::mitchell : FilterKind::box;
    const RenderedPixels all = Renderer(compiled.scene, settings).render(0, settings.crop, [] {});
    settings.noise = 0.03;
    const RenderedPixels whole = Renderer(compiled.scene, settings).render(0, settings.crop, [] {});
    const uint64_t eye_rays = whole.counts[RayKind::primary];
    EXPECT_LT(eye_rays, all.counts[RayKind::primary] * 9 / 10);
    EXPECT_GT(eye_rays, 22u * 22u * NoiseTarget::kBatch);
    size_t same = 0;
    for (int y = 0; y < 22; ++y)
      for (int x = 0; x < 22; ++x)
        same += row_of(whole, settings.crop, x, y, 1) == row_of(all, settings.crop, x, y, 1) ? 1 : 0;
    EXPECT_GT(same, 20u) << "pixels that need all samples are what they would be anyway";
    RayCounts sum;
    for (const PixelRect& rect : {PixelRect{0, 0, 7, 22}, PixelRect{7, 0, 22, 9}, PixelRect{7, 9, 22, 22}}) {
      const RenderedPixels part = Renderer(compiled.scene, settings).render(0, rect, [] {});
      sum += part.counts;
      for (int y = rect.y0; y < rect.y1; ++y)
        EXPECT_EQ(row_of(part, rect, rect.x0, y, rect.width()),
                  row_of(whole, settings.crop, rect.x0, y, rect.width()));
    }
    EXPECT_EQ(sum, whole.counts);
  }
}

TEST(NoiseTargets, IsBelowTheTarget) {
  const CompiledScene compiled = test_scene();
  RenderSettings settings = path_settings(4096);
  settings.pixel_format = PixelFormat::rgb8;
  settings.seed = 1;
  const RenderedPixels truth = Renderer(compiled.scene, settings).render(0, settings.crop, [] {});
  settings.seed = 0;
  settings.noise = 0.02;
  const RenderedPixels noisy = Renderer(compiled.scene, settings).render(0, settings.crop, [] {});
  EXPECT_LT(noisy.counts[RayKind::primary], truth.counts[RayKind::primary] / 4);
  double squares = 0;
  for (size_t i = 0; i < truth.pixels.size(); ++i) {
    const double difference =
        (std::to_integer<int>(noisy.pixels[i]) - std::to_integer<int>(truth.pixels[i])) / 255.0;
    squares += difference * difference;
  }
  const double rms = std::sqrt(squares / static_cast<double>(truth.pixels.size()));
  EXPECT_LT(rms, 0.02);
  EXPECT_GT(rms, 0.002) << "much more was done than asked for";
}

/// The pixels of the last of so many passes; `counts` of all.
RenderedPixels render_in_passes(const Scene& scene, const RenderSettings& settings, const PixelRect& rect,
                                uint32_t passes, RayCounts& counts) {
  RenderedPixels rendered;
  for (uint32_t pass = 0; pass < passes; ++pass) {
    const std::vector<std::byte> before = std::move(rendered.running);
    // A node that has never seen the rectangle.
    rendered = Renderer(scene, settings).render(0, rect, [] {}, {pass, passes, before});
    counts += rendered.counts;
    EXPECT_EQ(rendered.running.empty(), pass + 1 == passes);
  }
  return rendered;
}

TEST(Passes, TheLastGivesThePixelsAndCountsOfOne) {
  const CompiledScene compiled = test_scene();
  for (const LightingModel model : {LightingModel::whitted, LightingModel::thesis, LightingModel::path})
    for (const double noise : {0.0, 0.03}) {
      RenderSettings settings = path_settings(37);
      settings.lighting = model;
      settings.shutter = noise > 0 ? 0 : 0.5;
      settings.filter = FilterKind::mitchell;
      settings.noise = noise;
      const PixelRect rect{3, 1, 20, 12};
      const RenderedPixels once = Renderer(compiled.scene, settings).render(0, rect, [] {});
      EXPECT_TRUE(once.running.empty());
      for (const uint32_t passes : {2u, 5u, 37u}) {
        RayCounts counts;
        EXPECT_EQ(render_in_passes(compiled.scene, settings, rect, passes, counts).pixels, once.pixels)
            << passes;
        EXPECT_EQ(counts, once.counts);
      }
    }
}

TEST(Passes, EachShowsItsSamples) {
  const CompiledScene compiled = test_scene();
  RenderSettings settings = path_settings(16);
  const RenderedPixels first = Renderer(compiled.scene, settings).render(0, settings.crop, [] {}, {0, 4, {}});
  settings.samples = 4;
  EXPECT_EQ(first.pixels, Renderer(compiled.scene, settings).render(0, settings.crop, [] {}).pixels);
  EXPECT_EQ(first.running.size(), 22u * 22u * bytes_of_running(false));
}

TEST(Passes, GoOnFromTheirOwnPixelsOnly) {
  const CompiledScene compiled = test_scene();
  RenderSettings settings = path_settings(32);
  settings.noise = 0.1;
  Renderer renderer(compiled.scene, settings);
  const auto go_on = [&](std::span<const std::byte> before) {
    renderer.render(0, {0, 0, 4, 2}, [] {}, {1, 2, before});
  };
  RenderedPixels first = renderer.render(0, {0, 0, 4, 2}, [] {}, {0, 2, {}});
  EXPECT_NO_THROW(go_on(first.running));
  EXPECT_THROW(go_on(std::span(first.running).first(first.running.size() - 1)), std::runtime_error);
  EXPECT_THROW(go_on({}), std::runtime_error);
  first.running.back() = std::byte{1};  // more samples than any pixel has
  EXPECT_THROW(go_on(first.running), std::runtime_error);
}

}  // namespace
}  // namespace rayfarm
