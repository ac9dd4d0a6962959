#include "host/experiments/hierarchies/heat_map.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "common/compile/compile.h"
#include "common/hierarchy/ray_log.h"
#include "common/hierarchy/walk_counts.h"
#include "common/image/image_file.h"
#include "common/lighting/renderer.h"
#include "host/experiments/hierarchies/lettering.h"

namespace rayfarm {
namespace {

constexpr int kGap_px = 6;
constexpr int kLine_px = kLetterHeight_px + 6;
constexpr int kBar_px = 12, kLeastBar_px = 200, kMostBar_px = 640;
constexpr int kColours = 64;

/// The rays of each pixel, one behind the other.
struct PixelRays {
  std::vector<Ray> closest, any;
  std::vector<size_t> first_closest{0}, first_any{0};  ///< of each pixel, and one more
};

PixelRays record_by_pixels(const SceneDescription& description, int width_px, int height_px) {
  const CompiledScene compiled = compile(description);
  RayLog log;
  Scene scene = compiled.scene;
  scene.ray_log = &log;
  RenderSettings settings;
  settings.width_px = width_px;
  settings.height_px = height_px;
  settings.crop = {0, 0, width_px, height_px};
  settings.lighting = LightingModel::whitted;
  Renderer renderer(scene, settings);
  PixelRays rays;
  for (int y = 0; y < height_px; ++y)
    for (int x = 0; x < width_px; ++x) {
      renderer.render(0, {x, y, x + 1, y + 1}, [] {});
      rays.first_closest.push_back(log.closest.size());
      rays.first_any.push_back(log.any.size());
    }
  rays.closest = std::move(log.closest);
  rays.any = std::move(log.any);
  return rays;
}

HeatMap count_tests(const SceneDescription& description, const HeatPanel& panel, const PixelRays& rays) {
  const CompiledScene compiled = compile(description, panel.build);
  const Scene& scene = compiled.scene;
  FrameState state(scene);
  const Pose pose = state.at(0);
  HeatMap map{panel.name, {}, 0, 0};
  for (size_t pixel = 0; pixel + 1 < rays.first_closest.size(); ++pixel) {
    WalkCounts counts;
    for (size_t i = rays.first_closest[pixel]; i < rays.first_closest[pixel + 1]; ++i)
      closest_hit_counted(scene, pose, rays.closest[i], counts);
    for (size_t i = rays.first_any[pixel]; i < rays.first_any[pixel + 1]; ++i)
      any_hit_counted(scene, pose, rays.any[i], counts);
    map.tests.push_back(static_cast<double>(counts.primitives()));
    map.mean += map.tests.back();
    map.most = std::max(map.most, map.tests.back());
  }
  map.mean /= static_cast<double>(std::max<size_t>(1, map.tests.size()));
  return map;
}

Image make_canvas(int width_px, int height_px) {
  Image image;
  image.width_px = width_px;
  image.height_px = height_px;
  image.window = {0, 0, width_px, height_px};
  image.layout = make_pixel_layout(PixelFormat::rgb8);
  image.pixels.resize(3 * static_cast<size_t>(width_px) * static_cast<size_t>(height_px), std::byte{0xff});
  return image;
}

void set_pixel(Image& image, int x, int y, const std::array<std::byte, 3>& colour) {
  std::copy(colour.begin(), colour.end(),
            image.pixels.begin() + 3 * (static_cast<ptrdiff_t>(y) * image.width_px + x));
}

/// Of 10^0 to 10^decades; no test at all is black, as one is.
double share_of(double tests, int decades) {
  return tests < 1 ? 0 : std::min(1.0, std::log10(tests) / decades);
}

std::string number_of(double value) {
  return value < 100 ? fmt::format("{:.1f}", value) : fmt::format("{:.0f}", value);
}

}  // namespace

std::vector<HeatMap> measure_tests(const SceneDescription& scene, const std::vector<HeatPanel>& panels,
                                   int width_px, int height_px) {
  const PixelRays rays = record_by_pixels(scene, width_px, height_px);
  std::vector<HeatMap> maps;
  for (const HeatPanel& panel : panels) maps.push_back(count_tests(scene, panel, rays));
  return maps;
}

std::array<std::byte, 3> heat_colour(double share) {
  constexpr double kPi = 3.14159265358979323846, kStart = 0.5, kTurns = -1.5, kHue = 1;
  const double angle = 2 * kPi * (kStart / 3 + 1 + kTurns * share), c = std::cos(angle), s = std::sin(angle);
  const double away = kHue * share * (1 - share) / 2;
  const std::array<double, 3> rgb{share + away * (-0.14861 * c + 1.78277 * s),
                                  share + away * (-0.29227 * c - 0.90649 * s), share + away * 1.97294 * c};
  std::array<std::byte, 3> colour{};
  for (size_t i = 0; i < 3; ++i)
    colour[i] = static_cast<std::byte>(std::lround(255 * std::clamp(rgb[i], 0.0, 1.0)));
  return colour;
}

Image draw_heat_maps(const std::vector<HeatMap>& maps, int width_px, int height_px) {
  double most = 10;
  for (const HeatMap& map : maps) most = std::max(most, map.most);
  const int decades = static_cast<int>(std::ceil(std::log10(most) - 1e-9));
  const int count = static_cast<int>(maps.size());
  constexpr const char* kCaption = "tests per pixel";
  const int beside_bar_px = width_of_letters("100000") + 4 * kGap_px + width_of_letters(kCaption);
  const int panels_px = count * width_px + (count + 1) * kGap_px;
  Image image = make_canvas(std::max(panels_px, kLeastBar_px + beside_bar_px + 2 * kGap_px),
                            2 * kLine_px + height_px + kBar_px + kLine_px + 3 * kGap_px);
  const auto colour_of = [](double share) {
    return heat_colour(std::floor(share * (kColours - 1) + 0.5) / (kColours - 1));
  };
  for (int k = 0; k < count; ++k) {
    const HeatMap& map = maps[static_cast<size_t>(k)];
    const int left = kGap_px + k * (width_px + kGap_px), top = kGap_px + 2 * kLine_px;
    write_letters(image, left, kGap_px, map.name);
    write_letters(image, left, kGap_px + kLine_px, "mean " + number_of(map.mean));
    for (int y = 0; y < height_px; ++y)
      for (int x = 0; x < width_px; ++x)
        set_pixel(image, left + x, top + y,
                  colour_of(share_of(map.tests[static_cast<size_t>(y * width_px + x)], decades)));
  }
  const int left = kGap_px, top = 2 * kGap_px + 2 * kLine_px + height_px;
  const int length = std::min(kMostBar_px, image.width_px - 2 * kGap_px - beside_bar_px);
  for (int x = 0; x < length; ++x)
    for (int y = 0; y < kBar_px; ++y)
      set_pixel(image, left + x, top + y, colour_of(static_cast<double>(x) / length));
  for (int decade = 0; decade <= decades; ++decade)
    write_letters(image, left + decade * length / decades, top + kBar_px + 4,
                  fmt::format("{:.0f}", std::pow(10.0, decade)));
  write_letters(image, left + length + width_of_letters("100000") + 4 * kGap_px, top + kBar_px + 4, kCaption);
  return image;
}

std::string draw_tests(const std::string& path, const std::string& folder, int width_px, uint32_t cells) {
  const SceneDescription scene = load_scene(path);
  const auto [scene_width_px, scene_height_px] = scene.view.size_px();
  const int height_px = std::max(1, width_px * scene_height_px / scene_width_px);
  const std::vector<HeatPanel> panels{
      {"object", {.hierarchy = Hierarchy::object}},
      {"regular", {.hierarchy = Hierarchy::regular, .cells = cells}},
      {"adaptive", {.hierarchy = Hierarchy::adaptive, .max_primitives = 15}},
      {"thesis", {.hierarchy = Hierarchy::thesis, .max_primitives = 15}},
      {"sah", {}},
  };
  const std::vector<HeatMap> maps = measure_tests(scene, panels, width_px, height_px);
  const std::filesystem::path file = std::filesystem::path(folder) /
                                     fmt::format("tests_{}.png", std::filesystem::path(path).stem().string());
  write_image(file.string(), draw_heat_maps(maps, width_px, height_px), {});
  return file.string();
}

}  // namespace rayfarm
