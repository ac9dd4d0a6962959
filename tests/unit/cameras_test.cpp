// Ways to see: projections, shifts, near and far, and pictures of another aspect than the view's.
#include <cstring>
#include <numbers>

#include "common/lighting/renderer.h"
#include "common/scene/camera.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

using std::numbers::pi;

/// At (0, 0, 5), looking down -z, y up; `more`: keys of the view.
Camera camera_of(const std::string& more, int width_px, int height_px, Fit fit = Fit::width) {
  const CompiledScene compiled = compile(
      test::load_yaml("view: {location: [0, 0, 5], direction: [0, 0, -1], " + more + "}\nscene: []\n"));
  return make_camera(compiled.scene, 0, width_px, height_px, fit);
}

void expect_near(const Vec3& a, const Vec3& b, double tolerance = 1e-12) {
  EXPECT_NEAR(glm::length(a - b), 0, tolerance) << a.x << " " << a.y << " " << a.z;
}

TEST(Cameras, ParallelRaysOfAnOrthographicViewSpanItsWidth) {
  const Camera camera = camera_of("projection: orthographic, width: 8", 80, 40);
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, {40.0, 20.0}, {80.0, 40.0}}) {
    const Ray ray = camera.ray(x, y);
    expect_near(ray.origin, {x / 10 - 4, 2 - y / 10, 5});
    expect_near(ray.direction, {0, 0, -1});
  }
  EXPECT_EQ(camera.spread(), 0);
  EXPECT_NEAR(camera.width(), 0.1, 1e-15);
}

TEST(Cameras, APanoramaStepsEvenlyThroughLongitudeAndLatitude) {
  const Camera camera = camera_of("projection: panoramic", 360, 180);
  expect_near(camera.ray(180, 90).direction, {0, 0, -1});
  expect_near(camera.ray(270, 90).direction, {1, 0, 0});
  expect_near(camera.ray(0, 90).direction, {0, 0, 1});
  expect_near(camera.ray(180, 0).direction, {0, 1, 0});
  expect_near(camera.ray(225, 45).direction, {0.5, std::sqrt(0.5), -0.5});
  EXPECT_TRUE(camera.sees(1, 1));
  EXPECT_FALSE(camera_of("projection: panoramic", 360, 200).sees(180, 5)) << "above the zenith";
}

TEST(Cameras, AFisheyesAngleGrowsEvenlyFromTheMiddleOfADisk) {
  const Camera camera = camera_of("projection: fisheye, field_of_view: 180", 100, 100);
  expect_near(camera.ray(50, 50).direction, {0, 0, -1});
  expect_near(camera.ray(100, 50).direction, {1, 0, 0});
  expect_near(camera.ray(50, 25).direction, {0, std::sqrt(0.5), -std::sqrt(0.5)});
  EXPECT_TRUE(camera.sees(50, 0.1));
  EXPECT_FALSE(camera.sees(1, 1));
}

TEST(Cameras, AShiftMovesTheFrameAndKeepsItsPlane) {
  const Camera straight = camera_of("field_of_view: 90", 100, 50),
               shifted = camera_of("field_of_view: 90, shift: [0.25, -0.1]", 100, 50);
  expect_near(shifted.ray(25, 15).direction, straight.ray(50, 25).direction);
  const Camera parallel = camera_of("projection: orthographic, width: 8, shift: [0.25, 0]", 80, 40);
  expect_near(parallel.ray(40, 20).origin, {2, 0, 5});
  expect_near(camera_of("projection: panoramic, shift: [0.25, 0]", 360, 180).ray(90, 90).direction,
              {0, 0, -1});
}

TEST(Cameras, PointsAreSeenWhereRaysGo) {
  for (const char* view : {"field_of_view: 70, shift: [0.1, 0.2]", "projection: orthographic, width: 8",
                           "projection: panoramic", "projection: fisheye, field_of_view: 220"}) {
    const Camera camera = camera_of(view, 120, 80);
    for (double x = 20.5; x < 110; x += 13)
      for (double y = 10.5; y < 80; y += 11) {
        if (!camera.sees(x, y)) continue;
        const Ray ray = camera.ray(x, y), beside = camera.ray(x + 0.01, y), below = camera.ray(x, y + 0.01);
        const Vec3 p = ray.origin + 3.0 * ray.direction;
        const auto seen = camera.project(p);
        ASSERT_TRUE(seen) << view;
        EXPECT_NEAR(seen->raster.x, x, 1e-6) << view;
        EXPECT_NEAR(seen->raster.y, y, 1e-6) << view;
        // About so large is a pixel there, across the ray, along the shorter of its sides.
        const auto across = [&](const Ray& other) {
          return glm::length(glm::cross(other.origin + 3.0 * other.direction - p, ray.direction)) / 0.01;
        };
        const double px = std::min(across(beside), across(below)) * seen->px_per_length;
        EXPECT_TRUE(px > 0.5 && px < 1.5) << px << " " << view;
      }
  }
}

TEST(Cameras, NearAndFarCutAlongTheDirectionOfView) {
  const Camera camera = camera_of("field_of_view: 90, near: 1, far: 3", 100, 100);
  for (const double x : {50.0, 100.0}) {
    const Ray ray = camera.ray(x, 50);
    EXPECT_NEAR(ray.origin.z, 4, 1e-12);
    EXPECT_NEAR((ray.origin + ray.t_max * ray.direction).z, 2, 1e-12);
  }
  const Ray round = camera_of("projection: fisheye, near: 1, far: 3", 100, 100).ray(90, 50);
  EXPECT_NEAR(glm::length(round.origin - Vec3(0, 0, 5)), 1, 1e-12);
  EXPECT_NEAR(round.t_max, 2, 1e-12);
}

TEST(Cameras, APictureOfAnotherAspectIsAsWideCroppedOrBetweenBars) {
  const std::string view = "field_of_view: 90, aspect: 2";
  // Wide pictures: the frame is 1 high at distance 1 and 2 wide.
  EXPECT_NEAR(camera_of(view, 400, 100).ray(0, 50).direction.x, -std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(camera_of(view, 400, 100, Fit::crop).ray(0, 50).direction.x, -std::sqrt(0.5), 1e-12);
  const Camera bars = camera_of(view, 400, 100, Fit::letterbox);
  EXPECT_NEAR(bars.ray(100, 50).direction.x, -std::sqrt(0.5), 1e-12);
  EXPECT_FALSE(bars.sees(99, 50));
  EXPECT_TRUE(bars.sees(101, 50));
  // Tall ones.
  EXPECT_NEAR(camera_of(view, 100, 100).ray(0, 50).direction.x, -std::sqrt(0.5), 1e-12);
  const Camera cropped = camera_of(view, 100, 100, Fit::crop);
  expect_near(cropped.ray(50, 0).direction, normalized(Vec3(0, 0.5, -1)));
  expect_near(cropped.ray(0, 50).direction, normalized(Vec3(-0.5, 0, -1)));
  const Camera low = camera_of(view, 100, 100, Fit::letterbox);
  EXPECT_FALSE(low.sees(50, 24));
  EXPECT_TRUE(low.sees(50, 26));
  EXPECT_TRUE(camera_of(view, 200, 100, Fit::letterbox).sees_all());
}

/// In every lighting model: a luminous wall behind the view's far, before it and in front of its near.
TEST(Cameras, RaysOfEveryModelKeepToNearAndFarAndLeaveOutWhatIsNotSeen) {
  for (const LightingModel model : {LightingModel::phong, LightingModel::torrance_sparrow,
                                    LightingModel::whitted, LightingModel::thesis, LightingModel::path}) {
    const auto red_of = [&](const std::string& clip, int x, int y) {
      const CompiledScene compiled = compile(test::load_yaml(
          "view: {location: [0, 0, 5], direction: [0, 0, -1], projection: orthographic, width: 2, aspect: "
          "2, " +
          clip +
          "}\nbackground: [0, 1, 0]\nmaterials: {lamp: {luminaire: {color: 0, emission: [1, 0, 0]}}}\n"
          "scene: [{material: lamp, polygon: {points: [[-9,-9,0],[9,-9,0],[9,9,0],[-9,9,0]]}}]\n"));
      RenderSettings settings;
      settings.width_px = settings.height_px = 8;
      settings.crop = {0, 0, 8, 8};
      settings.lighting = model;
      settings.fit = Fit::letterbox;
      settings.pixel_format = PixelFormat::float32;
      const RenderedPixels rendered = Renderer(compiled.scene, settings).render(0, settings.crop, [] {});
      std::array<float, 3> color{};
      std::memcpy(color.data(), rendered.pixels.data() + static_cast<size_t>(y * 8 + x) * sizeof(color),
                  sizeof(color));
      return color;
    };
    const std::array<float, 3> red{1, 0, 0}, green{0, 1, 0}, nothing{0, 0, 0};
    EXPECT_EQ(red_of("near: 4, far: 6", 4, 4), red);
    EXPECT_EQ(red_of("far: 4.9", 4, 4), green);
    EXPECT_EQ(red_of("near: 5.1", 4, 4), green);
    EXPECT_EQ(red_of("near: 4", 4, 0), nothing) << "in a bar";
  }
}

TEST(Cameras, ViewsThatMakeNoSenseAreRefused) {
  for (const char* wrong :
       {"projection: round", "projection: orthographic", "width: 3", "projection: orthographic, width: 0",
        "projection: orthographic, width: 1, field_of_view: 40", "field_of_view: 180", "near: -1",
        "near: 2, far: 1", "projection: fisheye, field_of_view: 361",
        "projection: fisheye, lens: {radius: 1, focus: 2}", "shift: 1", "shift: [.nan, 0]"})
    EXPECT_THROW(camera_of(wrong, 4, 4), InputError) << wrong;
  EXPECT_NO_THROW(camera_of("projection: fisheye, field_of_view: 360", 4, 4));
}

}  // namespace
}  // namespace rayfarm
