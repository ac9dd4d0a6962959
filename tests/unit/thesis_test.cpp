// The thesis's model against answers that can be worked out by hand, and against other models.
#include <cstring>

#include "common/lighting/renderer.h"
#include "tests/unit/probe.h"

namespace rayfarm {
namespace {

TEST(Thesis, ReducesToWhittedAndPhong) {
  // With diffuse rays so weak that ambient light stands in for all of them, Equation 3.3 is 3.4: Whitted's
  // model with an ambient coefficient that equals the diffuse one.
  Probe probe(kMixedRoom + room("wall"));
  probe.settings.max_depth = 5;
  for (int i = 0; i < 40; ++i) {
    const Vec3 direction(std::sin(1.0 * i), std::cos(1.7 * i), std::sin(2.3 * i + 1));
    probe.settings.lighting = LightingModel::whitted;
    const Color whitted = probe.mean(Vec3(0, 0.3, 0.6), direction, 1);
    probe.settings.lighting = LightingModel::thesis;
    probe.settings.diffuse_rays = 7;
    probe.settings.diffuse_reach = 1e-200;
    expect_color(probe.mean(Vec3(0, 0.3, 0.6), direction, 1), whitted, 1e-9);
    // Of depth 2 the lighting tree is flat, and Whitted's model is Phong's.
    probe.settings.lighting = LightingModel::phong;
    const Color phong = probe.mean(Vec3(0, 0.3, 0.6), direction, 1);
    probe.settings.lighting = LightingModel::whitted;
    probe.settings.max_depth = 1;
    expect_color(probe.mean(Vec3(0, 0.3, 0.6), direction, 1), phong, 1e-12);
    probe.settings.max_depth = 5;
  }
}

TEST(Thesis, ConvergesToPathsWhereSurfacesAreDiffuse) {
  Probe probe(R"(
lights: [{position: [0.3, 0.5, 0.2], color: 0.8}]
materials: {wall: {lambertian: [0.5, 0.3, 0.2]}}
scene:
)" + room("wall"));
  const Vec3 origin(0, 0.1, 0.3), direction(0.2, -1, 0.1);
  const Color path = probe.mean(origin, direction, 1 << 15);
  probe.settings.lighting = LightingModel::thesis;
  probe.settings.max_depth = 12;
  expect_color(probe.mean(origin, direction, 1 << 13), path, 0.004);
}

TEST(Thesis, ConvergesToPathsInGoralsRoom) {
  // With all its rays, untrimmed and deep, the model is the rendering equation for diffuse surfaces. What the
  // plates leave out is what trimming takes away: light that was scattered more than once on its way.
  const CompiledScene compiled = compile(load_scene(std::string(RAYFARM_SOURCE) + "/scenes/goral_room.yaml"));
  RenderSettings settings;
  settings.width_px = settings.height_px = 32;
  settings.crop = {0, 0, 32, 32};
  settings.samples = 256;
  limit_by_depth(settings, 16);
  settings.pixel_format = PixelFormat::float32;
  const auto blocks = [&] {  // means of 8 × 8 pixels
    const RenderedPixels rendered = Renderer(compiled.scene, settings).render(0, settings.crop, [] {});
    std::array<Color, 16> means{};
    for (size_t i = 0; i < 32 * 32; ++i) {
      std::array<float, 3> pixel;
      std::memcpy(pixel.data(), rendered.pixels.data() + 12 * i, 12);
      means[i / 256 * 4 + i % 32 / 8] += Color(pixel[0], pixel[1], pixel[2]) / 64.0;
    }
    return means;
  };
  settings.lighting = LightingModel::path;
  const auto path = blocks();
  settings.lighting = LightingModel::thesis;
  settings.min_weight = 0;
  const auto gathered = blocks();
  settings.min_weight = 0.41;  // as the plates are trimmed
  const auto trimmed = blocks();
  double lost = 0;
  for (size_t i = 0; i < 16; ++i) {
    expect_color(gathered[i], path[i], 0.005);
    lost += (path[i].x - trimmed[i].x) / 16;
  }
  EXPECT_GT(lost, 0.05);
}

TEST(Thesis, CountsEachSourceOnce) {
  // A luminous ceiling is a primary source: shadow rays find it, diffuse rays must not find it again.
  Probe probe(R"(
materials: {m: {lambertian: 1}, lamp: {luminaire: {emission: 1}}}
scene:
  - {material: m, polygon: {points: [[-9,0,-9],[-9,0,9],[9,0,9],[9,0,-9]]}}
  - {material: lamp, polygon: {points: [[-2,1,-2],[2,1,-2],[2,1,2],[-2,1,2]]}}
)");
  const Color path = probe.mean(Vec3(1, 0.5, 0), Vec3(-1, -0.5, 0), 1 << 14);
  probe.settings.lighting = LightingModel::thesis;
  probe.settings.max_depth = 2;
  expect_color(probe.mean(Vec3(1, 0.5, 0), Vec3(-1, -0.5, 0), 1 << 14), path, 0.005);
}

TEST(Thesis, DiffuseDirectionsShareTheLightEvenly) {
  for (const uint32_t rays : {1u, 2u, 7u, 25u, 100u, 1000u}) {
    const DiffuseDirections directions(rays);
    ASSERT_EQ(directions.about_y().size(), rays);
    Vec3 sum(0);
    for (const Vec3& d : directions.about_y()) {
      EXPECT_NEAR(glm::length(d), 1, 1e-12);
      EXPECT_GE(d.y, 0);
      sum += d;
    }
    // Equal weights under cos θ / π: the mean direction is (0, 2/3, 0).
    if (rays >= 25) {
      EXPECT_NEAR(sum.y / rays, 2.0 / 3, 0.02);
    }
    if (rays >= 7) {
      EXPECT_NEAR(std::hypot(sum.x, sum.z) / rays, 0, 0.03);
    }
  }
  // 25 rays: one along the normal and four bands of six (Figure 3.1).
  const DiffuseDirections figure(25);
  EXPECT_EQ(figure.about_y()[0], Vec3(0, 1, 0));
  for (size_t band = 0; band < 4; ++band)
    for (size_t i = 1; i < 6; ++i)
      EXPECT_NEAR(figure.about_y()[1 + 6 * band + i].y, figure.about_y()[1 + 6 * band].y, 1e-12);
}

// Section 3.3: "Each cone should be of equal volume", within the sphere of Lambert's law: a cone of half
// angle θ about the normal holds 1 - cos⁴θ of it, and sin²θ of the light.
TEST(Thesis, BandsShareLightOrConeVolumeEvenly) {
  for (const DiffuseBands bands : {DiffuseBands::flux, DiffuseBands::cone}) {
    const auto share_inside = [&](double cosine) {
      return bands == DiffuseBands::flux ? 1 - cosine * cosine : 1 - std::pow(cosine, 4);
    };
    const DiffuseDirections directions(25, bands);
    for (size_t ray = 0; ray < 25; ++ray) {
      // From a band's inner rim to its outer one, ray by ray; their middle.
      const double first = ray == 0 ? 0 : static_cast<double>((ray - 1) / 6 * 6 + 1);
      const double count = ray == 0 ? 1 : 6;
      EXPECT_NEAR(share_inside(directions.jittered(ray, {0, 0.3}).y), first / 25, 1e-12);
      EXPECT_NEAR(share_inside(directions.jittered(ray, {1, 0.3}).y), (first + count) / 25, 1e-12);
      if (ray > 0) {
        EXPECT_NEAR(share_inside(directions.about_y()[ray].y), (first + count / 2) / 25, 1e-12);
      }
    }
    // What a sky of radiance cos θ brings: ∫ cos θ d(sin²θ) = 2/3; ∫ cos θ d(1 - cos⁴θ) = 4/5.
    const DiffuseDirections many(20000, bands);
    double sum = 0;
    for (const Vec3& d : many.about_y()) sum += d.y;
    EXPECT_NEAR(sum / 20000, bands == DiffuseBands::flux ? 2.0 / 3 : 4.0 / 5, 1e-3);
  }
}

// An even sky brings the same with both; a ball that covers 45 degrees about the zenith brings sin² 45° = 1/2
// of its radiance, and 1 - cos⁴ 45° = 3/4 with bands of equal cones.
TEST(Thesis, BandsOfEqualConesFavourTheZenith) {
  for (const DiffuseBands bands : {DiffuseBands::flux, DiffuseBands::cone}) {
    const auto floor_under = [&](const std::string& sky) {
      Probe probe(R"(
materials: {floor: {color: 1, ambient: 0, diffuse: 1}, ball: {luminaire: {emission: 1}}}
)" + sky + R"(
  - {material: floor, polygon: {points: [[-9,0,-9],[-9,0,9],[9,0,9],[9,0,-9]]}}
)");
      probe.settings.lighting = LightingModel::thesis;
      probe.settings.max_depth = 2;
      probe.settings.diffuse_rays = 10000;
      probe.settings.diffuse_bands = bands;
      return probe.mean(Vec3(0.5, 0.5, 0), Vec3(-0.5, -0.5, 0), 1).x;
    };
    EXPECT_NEAR(floor_under("background: 0.3\nscene:"), 0.3, 1e-12);
    const double half = bands == DiffuseBands::flux ? 0.5 : 0.75;
    // A quadric, which no shadow ray is sent to: the ball about (0, √200, 0) of radius 10.
    EXPECT_NEAR(floor_under("scene:\n  - {material: ball, quadric: {coefficients: [1, 1, 1, 0, 0, 0, 0, "
                            "-14.142135623730951, 0, 100]}}"),
                half, 0.01);
  }
}

TEST(Thesis, OneRayServesTheReflectedAndTheDiffuseTerm) {
  // A glossy floor in a room with a luminous ceiling. Of 64 diffuse rays one lies where the mirror shows; the
  // sum stays what Equation 3.6a gives for both terms.
  Probe probe(R"(
lights: [{position: [0.3, 0.5, 0.2], color: 0.8}]
materials:
  wall: {lambertian: [0.5, 0.3, 0.2]}
  floor: {color: 0.8, ambient: 0, diffuse: 0.5, reflect: 0.4}
  lamp: {luminaire: {emission: 2}}
scene:
  - {material: floor, polygon: {points: [[-1, -0.9, -1], [-1, -0.9, 1], [1, -0.9, 1], [1, -0.9, -1]]}}
  - {material: lamp, polygon: {points: [[-0.4, 0.9, -0.4], [0.4, 0.9, -0.4], [0.4, 0.9, 0.4], [-0.4, 0.9, 0.4]]}}
)" + room("wall"));
  const Vec3 origin(0, 0.1, 0.3), direction(0.1, -1, -0.1);  // it sees the lamp in the floor
  const Color path = probe.mean(origin, direction, 1 << 15);
  probe.settings.lighting = LightingModel::thesis;
  probe.settings.max_depth = 8;
  probe.settings.diffuse_rays = 1;
  probe.counts = {};
  const Color gathered = probe.mean(origin, direction, 1 << 13);
  expect_color(gathered, path, 0.02);
  EXPECT_GT(gathered.x, 0.8);  // 0.4 of the lamp's 2, and more
  probe.settings.max_depth = 2;
  probe.settings.diffuse_rays = 64;
  probe.counts = {};
  probe.mean(origin, direction, 1);
  EXPECT_EQ(probe.counts[RayKind::reflected], 1u);
  EXPECT_EQ(probe.counts[RayKind::diffuse], 63u);
}

TEST(Thesis, MoreRaysWhereNeighborsDiffer) {
  Probe probe(R"(
lights: [{position: [0.3, 0.5, 0.2], color: 0.8}]
materials: {wall: {lambertian: 0.5}, dark: {lambertian: 0}}
scene:
  - {material: dark, sphere: {center: [0.4, -0.6, 0], radius: 0.3}}
)" + room("wall"));
  probe.settings.lighting = LightingModel::thesis;
  probe.settings.max_depth = 2;
  probe.settings.diffuse_rays = 25;
  const Color few = probe.mean(Vec3(0, 0.1, 0), Vec3(0, -1, 0), 1);
  EXPECT_EQ(probe.counts[RayKind::diffuse], 25u);
  probe.counts = {};
  probe.settings.diffuse_contrast = 0.002;
  const Color more = probe.mean(Vec3(0, 0.1, 0), Vec3(0, -1, 0), 1);
  EXPECT_GT(probe.counts[RayKind::diffuse], 25u);
  EXPECT_LT(probe.counts[RayKind::diffuse], 50u);
  EXPECT_NE(few, more);
  probe.settings.diffuse_rays = 10000;
  probe.settings.diffuse_contrast = 0;
  const Color true_color = probe.mean(Vec3(0, 0.1, 0), Vec3(0, -1, 0), 1);
  expect_color(more, true_color, 0.03);
}

}  // namespace
}  // namespace rayfarm
