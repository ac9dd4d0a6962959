// Participating media in `path` and in the classical models against answers that can be worked out by hand,
// and against others of this program.
#include <numbers>

#include "common/lighting/medium_walk.h"
#include "common/lighting/renderer.h"
#include "common/sampling/warps.h"
#include "tests/unit/chi_square.h"
#include "tests/unit/probe.h"

namespace rayfarm {
namespace {

using std::numbers::pi;

/// A grid's file of numbers, and the keys that name it: `density` of the cell (x, y, z).
std::string grid_of(const std::string& name, const std::array<int, 3>& n,
                    const std::function<float(int, int, int)>& density) {
  std::string bytes;
  for (int z = 0; z < n[2]; ++z)
    for (int y = 0; y < n[1]; ++y)
      for (int x = 0; x < n[0]; ++x) {
        const float value = density(x, y, z);
        bytes.append(reinterpret_cast<const char*>(&value), 4);
      }
  test::write_temporary(name, bytes);
  return fmt::format("grid: {{file: {}, size: [{}, {}, {}], type: float32}}", name, n[0], n[1], n[2]);
}

/// Bumps of no symmetry, with an empty corner.
float lumpy(int x, int y, int z) {
  return x + y + z < 6 ? 0 : static_cast<float>((x * 7 + y * 5 + z * 3) % 11) / 10;
}

TEST(Media, HenyeyGreensteinIsSampledAsItIsEvaluated) {
  // Directions fit the density, whose integral over the sphere is 1 and whose mean cosine is g, by
  // definition.
  for (const double g : {-0.7, -0.2, 0.0, 0.4, 0.85}) {
    check_directions([&](const Vec2& u) { return sample_henyey_greenstein(u, g); },
                     [&](const Vec3& d) { return henyey_greenstein_pdf(d.z, g); });
    constexpr int kSteps = 20'000;
    double whole = 0, mean = 0, sampled = 0;
    for (int i = 0; i < kSteps; ++i) {
      const double cosine = -1 + 2 * (i + 0.5) / kSteps,
                   share = 4 * pi / kSteps * henyey_greenstein_pdf(cosine, g);
      whole += share;
      mean += cosine * share;
      sampled += sample_henyey_greenstein({(i + 0.5) / kSteps, 0.3}, g).z / kSteps;
    }
    EXPECT_NEAR(whole, 1, 1e-5) << g;
    EXPECT_NEAR(mean, g, 1e-5) << g;
    EXPECT_NEAR(sampled, g, 1e-5) << g;
  }
}

/// A white screen behind a slab from z = -1 to 1, which rays along z cross.
std::string slab(const std::string& medium) {
  return "background: 1\nmedia: [{box: {min: [-9, -9, -1], max: [9, 9, 1]}, " + medium + "}]\nscene: []\n";
}

TEST(Media, CollimatedLightFallsByBouguersLaw) {
  // e^(-κt d): the slab row of the table of numbers to show. Straight through 2 units, and aslant; from
  // within.
  for (const LightingModel model : {LightingModel::phong, LightingModel::torrance_sparrow,
                                    LightingModel::whitted, LightingModel::thesis, LightingModel::path}) {
    Probe probe(slab("absorption: [0.5, 1, 0]"));
    probe.settings.lighting = model;
    const Color two(std::exp(-1), std::exp(-2), 1), one(std::exp(-0.5), std::exp(-1), 1);
    expect_color(probe.mean({0, 0, 5}, {0, 0, -1}, 8), two, 1e-15);
    expect_color(probe.mean({0, 0, 5}, {0, 3, -4}, 8), Color(std::exp(-1.25), std::exp(-2.5), 1), 1e-15);
    expect_color(probe.mean({0, 0, 0}, {0, 0, -1}, 8), one, 1e-15);
    expect_color(probe.mean({0, 0, -2}, {0, 0, -1}, 8), Color(1), 0);
  }
}

TEST(Media, ScatteringTakesAsMuchFromTheBeamAsAbsorption) {
  // Behind the slab stands a lamp that shines at the eye alone (its radiance falls off with cos^1e6 off its
  // normal), so that what is scattered never returns: κt is the sum.
  Probe probe(
      "materials: {lamp: {luminaire: {emission: 1, exponent: 1000000}}}\n"
      "media: [{box: {min: [-9, -9, -1], max: [9, 9, 1]}, absorption: 0.1, scattering: [0.4, 0.9, 0.2], g: "
      "0.3}]\n"
      "scene: [{material: lamp, polygon: {points: [[-1, -1, -3], [1, -1, -3], [1, 1, -3], [-1, 1, -3]]}}]\n");
  const Color found = probe.mean({0, 0, 5}, {0, 0, -1}, 1 << 16);
  expect_color(found, Color(std::exp(-1.0), std::exp(-2.0), std::exp(-0.6)), 0.006);
}

TEST(Media, ShadowRaysAreWeakened) {
  // A sun straight above a floor under 2 units of a medium: what the floor shows falls by e^(-2κ), and by as
  // much again on the way to an eye straight above. In the classical models to rounding.
  const auto lit = [](const std::string& media, LightingModel model) {
    Probe probe("ambient: 0\nlights: [{direction: [0, -1, 0]}]\n" + media +
                "materials: {m: {lambertian: 0.5}}\n"
                "scene: [{material: m, polygon: {points: [[-9,0,-9],[-9,0,9],[9,0,9],[9,0,-9]]}}]\n");
    probe.settings.lighting = model;
    return probe.mean({0, 5, 0}, {0, -1, 0}, 8);
  };
  for (const LightingModel model :
       {LightingModel::phong, LightingModel::whitted, LightingModel::thesis, LightingModel::path}) {
    const Color clear = lit("", model);
    ASSERT_NEAR(clear.x, 0.5, 1e-12);
    const Color dim =
        lit("media: [{box: {min: [-2, 1, -2], max: [2, 3, 2]}, absorption: [0.3, 0.2, 0]}]\n", model);
    expect_color(dim / clear, Color(std::exp(-1.2), std::exp(-0.8), 1), 1e-14);
  }
}

TEST(Media, FurnaceOfAScatteringMediumIsWhatItIsWithoutOne) {
  // A closed room whose walls emit E and reflect ρ, filled with a medium that absorbs nothing: L = E + ρ L at
  // every wall and along every ray, so E / (1 - ρ), whatever is scattered. A grey medium adds no noise; with
  // colours and a grid, which reaches beyond the walls, paths of one channel are worth more than others.
  const auto expect_furnace = [](const std::string& medium, uint32_t samples, double tolerance) {
    Probe probe(
        "materials: {m: {luminaire: {color: [0.2, 0.5, 0.8], emission: [1, 2, 0.5]}}}\n"
        "media: [{box: {min: [-1.1, -1.1, -1.1], max: [1.1, 1.1, 1.1]}, " +
        medium + "}]\nscene:\n" + room("m"));
    const Color found = probe.mean(Vec3(0.1, 0.2, 0), Vec3(0.3, 1, 0.2), samples);
    expect_color(found / Color(1.25, 4, 2.5), Color(1), tolerance);
  };
  expect_furnace("scattering: 1.5, g: 0.6", 1 << 15, 0.004);
  expect_furnace("scattering: [2, 1, 0.3], g: -0.4, " + grid_of("lumps.raw", {9, 10, 11}, lumpy), 1 << 14,
                 0.02);
}

/// The share of diffuse light that gets through a slab of this optical depth: a white screen of radiance 1
/// lights it from behind, and the mean over the hemisphere of what leaves it before is taken by a white
/// surface there that faces it, of albedo 1, whose light is irradiance / π.
double through_slab(const std::string& medium, double depth, uint32_t samples) {
  Probe probe(fmt::format(R"(
materials: {{white: {{lambertian: 1}}, lamp: {{luminaire: {{emission: 1, color: 0}}}}}}
media: [{{box: {{min: [-2000, -2000, 0], max: [2000, 2000, 1]}}, {}}}]
scene:
  - {{material: lamp, polygon: {{points: [[-3000,-3000,-0.1],[3000,-3000,-0.1],[3000,3000,-0.1],[-3000,3000,-0.1]]}}}}
  - {{material: white, polygon: {{points: [[-0.001,-0.001,1.1],[-0.001,0.001,1.1],[0.001,0.001,1.1],[0.001,-0.001,1.1]]}}}}
)",
                          fmt::vformat(medium, fmt::make_format_args(depth))));
  return probe.mean(Vec3(0.0001, 0.0002, 1.05), Vec3(0, 0, 1), samples).x;
}

TEST(Media, AbsorbingSlabPassesTwiceE3) {
  // 2 E₃(τ) of diffuse light (its definition: ∫ e^(-τ / μ) 2 μ dμ).
  for (const auto& [depth, share] : {std::pair(0.5, 0.4432), {1.0, 0.2194}, {2.0, 0.0603}})
    EXPECT_NEAR(through_slab("absorption: {}", depth, 1 << 14) / share, 1, 0.01) << depth;
}

TEST(Media, WhiteIsotropicSlabPassesWhatChandrasekharSays) {
  // The transmittance of a conservative isotropic slab for diffuse light (Chandrasekhar 1960, by X and Y
  // functions): 0.704, 0.553, 0.390.
  for (const auto& [depth, share] : {std::pair(0.5, 0.704), {1.0, 0.553}, {2.0, 0.390}})
    EXPECT_NEAR(through_slab("scattering: {}", depth, 1 << 16) / share, 1, 0.01) << depth;
}

TEST(Media, ThinMediumAboutAPointLightShowsTheArcTangents) {
  // Scattered once: a point of power Φ = 4π I at distance h from the ray lights it from a to b:
  // κs Φ / (16π² h) (atan(b/h) - atan(a/h)), for κt so small that nothing else happens.
  const double h = 0.7, a = -1, b = 2.5, scattering = 1e-3, power = 4 * pi * 3;
  for (const std::string& grid :
       {std::string(), ", " + grid_of("one.raw", {3, 2, 4}, [](int, int, int) { return 1.f; })}) {
    Probe probe(
        fmt::format("lights: [{{position: [0, 0, 0], falloff: true, color: 3}}]\n"
                    "media: [{{box: {{min: [{}, -5, -5], max: [{}, 5, 5]}}, scattering: {}{}}}]\nscene: []\n",
                    a, b, scattering, grid));
    const double expected = scattering * power / (16 * pi * pi * h) * (std::atan(b / h) - std::atan(a / h));
    const Ray ray{{-5, h, 0}, {1, 0, 0}};
    const MediumSegments segments = media_along(probe.compiled.scene, ray);
    ASSERT_EQ(segments.size(), 1u);
    EXPECT_NEAR(segments[0].t0, 5 + a, 1e-12);
    EXPECT_NEAR(segments[0].t1, 5 + b, 1e-12);
    EXPECT_NEAR(probe.mean(ray.origin, ray.direction, 1 << 18).x / expected, 1, 0.01);
  }
}

TEST(Media, GridsAreIntegratedExactly) {
  // By many small steps of the density itself.
  const Probe probe(slab("absorption: 1, " + grid_of("lumps.raw", {9, 10, 11}, lumpy)));
  const Scene& scene = probe.compiled.scene;
  std::mt19937 random(3);
  for (int i = 0; i < 20; ++i) {
    const Vec3 from(test::uniform(random, -9, 9), test::uniform(random, -9, 9), i % 3 == 0 ? 0.3 : 2),
        to(test::uniform(random, -12, 12), test::uniform(random, -9, 9), test::uniform(random, -1.5, 0.2));
    const Ray ray{from, i == 1 ? Vec3(0, 0, -3) : to - from};
    const MediumSegments segments = media_along(scene, ray);
    ASSERT_EQ(segments.size(), 1u);
    const auto [medium, t0, t1] = segments[0];
    constexpr int kSteps = 100'000;
    double sum = 0;
    for (int k = 0; k < kSteps; ++k)
      sum += density_at(scene, scene.media[0],
                        ray.origin + (t0 + (t1 - t0) * (k + 0.5) / kSteps) * ray.direction);
    const double whole = sum * (t1 - t0) / kSteps * glm::length(ray.direction);
    EXPECT_NEAR(density_along(scene, ray, segments[0]), whole, 1e-6 * (1 + whole));
  }
}

TEST(Media, MajorantsAreAboveEveryDensity) {
  const Probe probe(slab("absorption: 1, " + grid_of("big.raw", {17, 24, 9}, lumpy)));
  const Scene& scene = probe.compiled.scene;
  std::mt19937 random(5);
  for (int i = 0; i < 300; ++i) {
    const Ray ray{{test::uniform(random, -9, 9), test::uniform(random, -9, 9), 2},
                  test::random_point(random, 1) - Vec3(0, 0, 1.5)};
    for (const MediumSegment& segment : media_along(scene, ray)) {
      double reached = segment.t0;
      for (MajorantWalk block(scene, ray, segment); block.next(); reached = block.t1())
        for (int k = 0; k < 20; ++k) {
          const double t = block.t0() + (block.t1() - block.t0()) * (k + 0.5) / 20;
          ASSERT_LE(density_at(scene, scene.media[0], ray.origin + t * ray.direction),
                    block.majorant() * (1 + 1e-12));
        }
      EXPECT_LE(reached, segment.t1);
    }
  }
}

TEST(Media, TrackingMeansWhatTheIntegralSays) {
  // Ratio tracking of shadow rays and delta tracking of paths, in a grid of three channels and in a
  // homogeneous box behind it, against the exact transmittance: what gets through of each channel is e^-depth
  // in the mean, and what is scattered the rest times its albedo.
  const Probe probe(
      "background: 1\nmedia:\n"
      "  - {box: {min: [-1, -1, -1], max: [1, 1, 1]}, absorption: 0.5, scattering: [0.2, 1, 2], " +
      grid_of("lumps.raw", {9, 10, 11}, lumpy) +
      "}\n  - {box: {min: [1, -1, -1], max: [2, 1, 1]}, scattering: [0.5, 0.1, 0], absorption: [0, 0.1, "
      "0.4]}\nscene: []\n");
  const Scene& scene = probe.compiled.scene;
  const SamplingTables tables(probe.settings, 0);
  const Ray ray{{-3, 0.1, 0.2}, {2, 0.1, -0.15}, 4};
  const Color exact = transmittance(scene, ray);
  constexpr uint32_t kWalks = 1 << 18;
  Color ratio(0), delta(0);
  for (uint32_t i = 0; i < kWalks; ++i) {
    MediumNumbers shadow(tables.sampler, {1, 2, i}, dimension::of_walk(1, dimension::kShadow)),
        free(tables.sampler, {1, 2, i}, dimension::of_walk(1, dimension::kFree));
    ratio += estimate_transmittance(scene, ray, shadow) / double{kWalks};
    Color throughput(1);
    const MediumEvent event = walk_through_media(scene, ray, throughput, free);
    if (!event.is_scattered()) delta += throughput / double{kWalks};
    if (event.is_scattered()) {
      EXPECT_GT(event.t, 0);
      EXPECT_LT(event.t, ray.t_max);
    }
    EXPECT_LE(throughput.x + throughput.y + throughput.z, 3 * (1 + 1e-9))
        << "the sum of channels never grows";
  }
  expect_color(ratio / exact, Color(1), 0.01);
  expect_color(delta / exact, Color(1), 0.02);
}

TEST(Media, WalksEndWhereDistancesAreRounded) {
  // From so far away that numbers along the ray are a unit apart, half the length of the box: steps do not
  // move it.
  const Probe probe(slab("scattering: 1000, " + grid_of("lumps.raw", {9, 10, 11}, lumpy)));
  const Scene& scene = probe.compiled.scene;
  const SamplingTables tables(probe.settings, 0);
  const Ray ray{{5, 5, 9e15}, {0, 0, -1}};
  ASSERT_EQ(media_along(scene, ray).size(), 1u);
  for (uint32_t i = 0; i < 100; ++i) {
    MediumNumbers shadow(tables.sampler, {1, 2, i}, dimension::of_walk(1, dimension::kShadow)),
        free(tables.sampler, {1, 2, i}, dimension::of_walk(1, dimension::kFree));
    const Color left = estimate_transmittance(scene, ray, shadow);
    EXPECT_GE(left.x, 0);
    EXPECT_LE(left.x, 1);
    Color throughput(1);
    EXPECT_TRUE(std::isfinite(walk_through_media(scene, ray, throughput, free).t));
  }
}

TEST(Media, AConstantGridIsAHomogeneousBox) {
  const auto mean = [](const std::string& grid, LightingModel model, uint32_t samples) {
    Probe probe(
        "ambient: 0.2\nlights: [{position: [1, 2, 1], color: 2}]\n"
        "media: [{box: {min: [-1, -1, -1], max: [1, 1, 1]}, absorption: 0.4, scattering: [0.8, 0.4, 0.2]" +
        grid +
        "}]\nmaterials: {m: {color: 0.8}}\nscene: [{material: m, sphere: {center: [0, 0, 0], radius: "
        "0.5}}]\n");
    probe.settings.lighting = model;
    return probe.mean({0.3, 0.4, 5}, {-0.02, 0, -1}, samples);
  };
  const std::string grid = ", " + grid_of("one.raw", {3, 20, 4}, [](int, int, int) { return 1.f; });
  expect_color(mean(grid, LightingModel::whitted, 8), mean("", LightingModel::whitted, 8), 1e-12);
  expect_color(mean(grid, LightingModel::path, 1 << 16) / mean("", LightingModel::path, 1 << 16), Color(1),
               0.01);
}

TEST(Media, PicturesDoNotDependOnLanesOrCuts) {
  // Each path by itself, and each pixel in a rectangle of its own, give the same bytes.
  const SceneDescription description = test::load_yaml(
      test::view_text() + kMixedRoom +
      "media:\n  - {box: {min: [-1, -1, -1], max: [0, 1, 1]}, scattering: [0.3, 0.5, 0.7], g: 0.5, " +
      grid_of("lumps.raw", {9, 10, 11}, lumpy) +
      "}\n  - {box: {min: [0, -1, -1], max: [1, 1, 1]}, scattering: 0.4, absorption: [0.1, 0, 0.2]}\n");
  const CompiledScene compiled = compile(description);
  for (const LightingModel model : {LightingModel::path, LightingModel::whitted}) {
    RenderSettings settings = test::picture_settings(9, 7, model);
    settings.samples = 3;
    Renderer renderer(compiled.scene, settings);
    const RenderedPixels whole = renderer.render(0, settings.crop, [] {});
    const size_t pixel_bytes = whole.pixels.size() / 63;
    for (int y = 0; y < 7; ++y)
      for (int x = 0; x < 9; ++x) {
        const RenderedPixels one = renderer.render(0, {x, y, x + 1, y + 1}, [] {});
        ASSERT_EQ(
            std::memcmp(one.pixels.data(), whole.pixels.data() + static_cast<size_t>(y * 9 + x) * pixel_bytes,
                        pixel_bytes),
            0)
            << x << ", " << y;
      }
  }
}

}  // namespace
}  // namespace rayfarm
