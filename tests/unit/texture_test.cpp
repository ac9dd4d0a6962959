// Textures, parameters of surfaces, and image files: values that can be worked out by hand.
#include <set>

#include "common/image/half_float.h"
#include "common/image/image_file.h"
#include "common/lighting/textured.h"
#include "common/textures/array_texture.h"
#include "common/textures/image_texture.h"
#include "common/textures/noise.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

TEST(Noise, IsZeroOnTheLatticeSmoothAndBounded) {
  std::mt19937 random(1);
  double least = 0, most = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 p = test::random_point(random, 50);
    EXPECT_NEAR(solid_noise(glm::floor(p), 3), 0, 1e-12);
    const double n = solid_noise(p, 3);
    least = std::min(least, n);
    most = std::max(most, n);
    EXPECT_NEAR(solid_noise(p + Vec3(1e-6), 3), n, 1e-5);
  }
  EXPECT_LT(most, 1.05);
  EXPECT_GT(most, 0.7);
  EXPECT_GT(least, -1.05);
  EXPECT_LT(least, -0.7);
  EXPECT_NE(solid_noise(Vec3(0.3, 0.4, 0.5), 1), solid_noise(Vec3(0.3, 0.4, 0.5), 2));
  EXPECT_EQ(turbulence(Vec3(0.3, 0.4, 0.5), 5, 1, 100), 0);  // all octaves are narrower than the ray
}

TEST(Textures, EachBoardHasOneLook) {
  Texture t;
  t.kind = TextureKind::boards;
  t.aspect = 8;
  t.gap = 0;
  std::set<int> looks;
  for (int row = 0; row < 12; ++row) {
    // The middle of two points a whole tree's ring apart tells nothing; the tint of a board does: its
    // brightest point.
    double brightest = 0;
    for (int i = 0; i < 4000; ++i) {
      const double x = cell_number({row, 7, 0}, 0) * -8 + 0.5 + 7.0 * i / 4000;  // within one board
      brightest = std::max(brightest, eval_texture(t, {}, {{x, 0, row + 0.5}, {}, 0, 0}).x);
    }
    EXPECT_GT(brightest, 0.5);
    looks.insert(static_cast<int>(brightest * 1000));
  }
  EXPECT_GT(looks.size(), 8u);
}

TEST(Textures, FarPatternsAreTheirMean) {
  for (const TextureKind kind : {TextureKind::checker, TextureKind::noise, TextureKind::fourier}) {
    Texture t;
    t.kind = kind;
    t.first = Color(1);
    t.second = Color(0);
    const Color far = eval_texture(t, {}, {{0.3, 0.4, 0.6}, {}, 50, 0});
    EXPECT_NEAR(far.x, 0.5, 1e-9) << static_cast<int>(kind);
  }
}

TEST(Textures, ImagesEndAsTheyAreToldTo) {
  // Three pixels in a row: 0, 0.5 and 1.
  Texture t;
  t.kind = TextureKind::image;
  t.width_px = 3;
  t.height_px = t.levels = 1;
  std::vector<uint16_t> texels;
  for (const float value : {0.f, 0.5f, 1.f})
    for (int c = 0; c < 3; ++c) texels.push_back(half_of_float(value));
  const auto at = [&](double u) { return eval_texture(t, texels, {{}, {u, 0.5}, 0, 0}).x; };
  const auto middle = [](int i) { return (i + 0.5) / 3; };  // of the pixel
  t.wraps[0] = TextureWrap::mirror;
  for (int i = -7; i <= 7; ++i) {
    const int in_period = ((i % 6) + 6) % 6, place = in_period < 3 ? in_period : 5 - in_period;
    EXPECT_NEAR(at(middle(i)), 0.5 * place, 1e-9) << i;
  }
  EXPECT_NEAR(at(1), 1, 1e-9);  // between a pixel and its image in the mirror
  t.wraps[0] = TextureWrap::clamp;
  for (int i = -7; i <= 7; ++i) EXPECT_NEAR(at(middle(i)), 0.5 * std::clamp(i, 0, 2), 1e-9) << i;
  EXPECT_EQ(at(1e300), 1);
  EXPECT_EQ(at(-1e300), 0);
  t.wraps[0] = TextureWrap::repeat;
  EXPECT_NEAR(at(1), 0.5, 1e-9);  // between the last and the first
  EXPECT_NEAR(at(0.4), 0.5 * 0.7, 1e-3);
  t.is_nearest = 1;
  EXPECT_EQ(at(0.3334), 0.5);
  EXPECT_EQ(at(0.3332), 0);
  EXPECT_EQ(at(0.9999), 1);
}

TEST(Textures, CheckerAlternatesInAllThreeDirections) {
  Texture t;
  const auto at = [&](double x, double y, double z) { return eval_texture(t, {}, {{x, y, z}, {}, 0, 0}).x; };
  EXPECT_EQ(at(0.5, 0.5, 0.5), 1);
  EXPECT_EQ(at(1.5, 0.5, 0.5), 0);
  EXPECT_EQ(at(0.5, 1.5, 0.5), 0);
  EXPECT_EQ(at(0.5, 0.5, -0.5), 0);
  EXPECT_EQ(at(-0.5, -0.5, 0.5), 1);
}

/// Without its pixels.
Image rgb8_image(int width_px, int height_px) {
  return {width_px, height_px, {0, 0, width_px, height_px}, make_pixel_layout(PixelFormat::rgb8), {}};
}

TEST(Textures, ImagesAreReadInterpolatedAndHalved) {
  // 4 × 2 texels, the left half white and the right half black.
  Image image = rgb8_image(4, 2);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 4; ++x)
      for (int c = 0; c < 3; ++c) image.pixels.push_back(static_cast<std::byte>(x < 2 ? 255 : 0));
  const std::string path = test::write_temporary("texture.png", "");
  write_image(path, image, {});
  Texture t;
  t.kind = TextureKind::image;
  const std::vector<uint16_t> texels = load_texels(path, t, limits::kTexturePixels);
  EXPECT_EQ(t.levels, 3u);  // 4×2, 2×1, 1×1
  EXPECT_EQ(texels.size(), 3u * (8 + 2 + 1));
  const auto at = [&](double u, double v, double width) {
    return eval_texture(t, texels, {{}, {u, v}, 0, width}).x;
  };
  EXPECT_NEAR(at(0.25, 0.5, 0), 1, 1e-9);
  EXPECT_NEAR(at(0.75, 0.5, 0), 0, 1e-9);
  EXPECT_NEAR(at(0.5, 0.5, 0), 0.5, 1e-9);     // between the two middle texels
  EXPECT_NEAR(at(1.25, 0.5, 0), 1, 1e-9);      // repeated
  EXPECT_NEAR(at(0.25, 0.5, 100), 0.5, 1e-3);  // from afar: the mean
}

TEST(Textures, LevelsOfOddSizesKeepTheMean) {
  // 7 × 5 texels, of which no two are alike and the last are the brightest; encoded as light is.
  Image image = rgb8_image(7, 5);
  double mean = 0;
  for (int i = 0; i < 35; ++i) {
    for (int c = 0; c < 3; ++c) image.pixels.push_back(static_cast<std::byte>(7 * i));
    mean += 7 * i / 255.0 / 35;
  }
  const std::string path = test::write_temporary("odd.png", "");
  write_image(path, image, {});
  Texture t;
  const std::vector<uint16_t> texels =
      load_texels(path, t, limits::kTexturePixels, {}, {ImagePart::color, ImageReading::Encoding::linear});
  ASSERT_EQ(texels.size(), 3u * (35 + 3 * 2 + 1));
  double level_mean = 0;
  for (size_t i = 35; i < 41; ++i) level_mean += static_cast<double>(float_of_half(texels[3 * i])) / 6;
  EXPECT_NEAR(level_mean, mean, 5e-4);  // halves
  EXPECT_NEAR(static_cast<double>(float_of_half(texels[3 * 41])), mean, 5e-4);

  ArrayValues array{{5, 3, 1}, 1, {}};
  for (int i = 0; i < 15; ++i) array.values.push_back(static_cast<float>(i) / 15);
  Texture space;
  const std::vector<uint16_t> cells = make_array_texels(array, space, {});
  ASSERT_EQ(cells.size(), 3u * (15 + 2 + 1));
  EXPECT_NEAR(static_cast<double>(float_of_half(cells[3 * 17])), 7.0 / 15, 5e-4);
}

struct Parameters {
  explicit Parameters(const std::string& text)
      : compiled(compile(test::load_yaml(test::view_text() + text))),
        frame_pose(compiled.scene),
        pose(frame_pose.at(0)) {}
  Vec2 at(const Vec3& origin, const Vec3& direction) {
    const Ray ray{origin, normalized(direction)};
    const Hit hit = closest_hit(compiled.scene, pose, ray);
    EXPECT_TRUE(hit.is_hit());
    const Vec3 p = ray.origin + hit.t * ray.direction;
    return surface_parameters(compiled.scene, hit, pose[hit.instance].object_from_world.point(p));
  }
  CompiledScene compiled;
  FrameState frame_pose;
  Pose pose;
};

void expect_uv(const Vec2& uv, double u, double v) {
  EXPECT_NEAR(uv.x, u, 1e-6);
  EXPECT_NEAR(uv.y, v, 1e-6);
}

TEST(Parameters, OfSpheresAndQuadrilaterals) {
  Parameters sphere("scene: [{sphere: {center: [1, 2, 3], radius: 2}}]\n");
  expect_uv(sphere.at(Vec3(9, 2, 3), Vec3(-1, 0, 0)), 0, 0.5);
  expect_uv(sphere.at(Vec3(1, 2, 9), Vec3(0, 0, -1)), 0.25, 0.5);
  expect_uv(sphere.at(Vec3(1, 2, -9), Vec3(0, 0, 1)), 0.75, 0.5);
  EXPECT_NEAR(sphere.at(Vec3(1, 9, 3.001), Vec3(0, -1, 0)).y, 1, 1e-3);
  // A trapezium: the middle between the parallel sides is at v = 1/2 on every line of constant u.
  Parameters patch("scene: [{polygon: {points: [[0,0,0],[4,0,0],[3,2,0],[1,2,0]]}}]\n");
  expect_uv(patch.at(Vec3(2, 1, 5), Vec3(0, 0, -1)), 0.5, 0.5);
  expect_uv(patch.at(Vec3(0.5 + 0.25 * 3, 1, 5), Vec3(0, 0, -1)), 0.25, 0.5);
  expect_uv(patch.at(Vec3(1.5, 2 - 1e-9, 5), Vec3(0, 0, -1)), 0.25, 1);
  Parameters square("scene: [{polygon: {points: [[0,0,0],[2,0,0],[2,2,0],[0,2,0]]}}]\n");
  expect_uv(square.at(Vec3(0.5, 1.5, 5), Vec3(0, 0, -1)), 0.25, 0.75);
}

TEST(Parameters, OfMeshesWithCoordinates) {
  const std::string path = test::write_temporary(
      "uv.obj", "v 0 0 0\nv 2 0 0\nv 0 2 0\nvt 0.1 0.2\nvt 0.5 0.2\nvt 0.1 0.8\nf 1/1 2/2 3/3\n");
  Parameters mesh("scene: [{sphere: {center: [50, 0, 0], radius: 1}}, {mesh: {file: uv.obj}}]\n");
  expect_uv(mesh.at(Vec3(0.5, 0.5, 5), Vec3(0, 0, -1)), 0.1 + 0.25 * 0.4, 0.2 + 0.25 * 0.6);
}

TEST(Textured, BumpsTiltTheNormalAsTheirSlopeDoes) {
  // White rises over black by `height` along x: checks of side 1 smoothed away from edges have no slope; a
  // fourier ramp has. Here the tilt is compared with the slope of the texture itself.
  Parameters world(R"(
textures: {waves: {kind: fourier, octaves: 1, scale: 4}}
materials: {m: {lambertian: 1, bump: {texture: waves, height: 0.5}}}
scene: [{material: m, polygon: {points: [[-5,-5,0],[5,-5,0],[5,5,0],[-5,5,0]]}}]
)");
  const Scene& scene = world.compiled.scene;
  const Ray ray{Vec3(0.7, 0.3, 5), Vec3(0, 0, -1)};
  const Hit hit = closest_hit(scene, world.pose, ray);
  Surface surface = eval_surface(scene, world.pose, ray, hit);
  textured(scene, world.pose, ray, hit, 0, 0, surface);
  const auto height = [&](double x, double y) {
    return 0.5 * eval_texture(scene.textures[0], scene.texels, {{x, y, 0}, {}, 0, 0}).x;
  };
  const double e = 1e-4, sx = (height(0.7 + e, 0.3) - height(0.7 - e, 0.3)) / (2 * e),
               sy = (height(0.7, 0.3 + e) - height(0.7, 0.3 - e)) / (2 * e);
  const Vec3 expected = normalized(Vec3(-sx, -sy, 1));
  EXPECT_GT(std::abs(sx) + std::abs(sy), 0.01);
  EXPECT_NEAR(glm::length(surface.shading_normal - expected), 0, 1e-3);
}

TEST(Textured, ErrorsHaveTheirPlace) {
  EXPECT_NE(test::error_of(
                "view: {location: [0,0,5], look_at: [0,0,0]}\ntextures: {a: {kind: checkers}}\nscene: []\n")
                .find(":2:"),
            std::string::npos);
  const std::string unknown = test::error_of(
      "view: {location: [0,0,5], look_at: [0,0,0]}\ntextures: {brick: {kind: bricks}}\nmaterials: {m: "
      "{texture: brik}}\nscene: []\n");
  EXPECT_NE(unknown.find("did you mean 'brick'"), std::string::npos) << unknown;
  const std::string missing = test::error_of(
      "view: {location: [0,0,5], look_at: [0,0,0]}\ntextures: {a: {kind: image, file: none.png}}\nscene: "
      "[]\n");
  EXPECT_NE(missing.find("scene.yaml:2:"), std::string::npos) << missing;
  EXPECT_NE(missing.find("none.png"), std::string::npos);
}

}  // namespace
}  // namespace rayfarm
