// Analytic answers: what Equations 2.4 and 2.12 give where they can be worked out by hand.
#include <cstring>

#include "common/lighting/renderer.h"
#include "common/math/portable_math.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

struct World {
  explicit World(const std::string& text)
      : compiled(compile(test::load_yaml(text))), frame_pose(compiled.scene), pose(frame_pose.at(0)) {}
  Color trace(const Vec3& origin, const Vec3& direction) {
    const Ray ray{origin, normalized(direction)};
    const SampleId id;
    Color color;
    make_integrator(settings.lighting)
        ->trace({compiled.scene, pose, SamplingTables(settings, 0)}, std::span(&ray, 1), std::span(&id, 1),
                counts, &color);
    return color;
  }
  CompiledScene compiled;
  FrameState frame_pose;
  Pose pose;
  RenderSettings settings;
  RayCounts counts;
};

void expect_color(const Color& a, const Color& b, double tolerance = 1e-12) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST(Lighting, PhongTermsOnAPlane) {
  // Light at 45° over the point, viewer straight above: I = C (ka Ia + kd I cos 45°) + ks I cos(45°)^n.
  World world(test::view_text() + R"(
ambient: 0.5
lights: [{position: [3, 3, 0], color: [0.9, 0.8, 0.7]}]
materials: {m: {color: [1, 0.5, 0.25], ambient: 0.2, diffuse: 0.6, specular: 0.3, shininess: 4}}
scene: [{material: m, polygon: {points: [[-9, 0, 9], [9, 0, 9], [9, 0, -9], [-9, 0, -9]]}}]
)");
  const double c = std::sqrt(0.5);
  const Color light(0.9, 0.8, 0.7),
      expected = Color(1, 0.5, 0.25) * (Color(0.1) + 0.6 * c * light) + 0.3 * 0.25 * light;
  expect_color(world.trace(Vec3(0, 5, 0), Vec3(0, -1, 0)), expected);
  expect_color(world.trace(Vec3(0, -5, 0), Vec3(0, 1, 0)), Color(1, 0.5, 0.25) * 0.1);  // the unlit side
}

TEST(Lighting, ShadowsBlockFully) {
  World world(test::view_text() + R"(
ambient: 0
lights: [{position: [0, 10, 0]}]
scene:
  - {polygon: {points: [[-9, 0, 9], [9, 0, 9], [9, 0, -9], [-9, 0, -9]]}}
  - {sphere: {center: [0, 5, 0], radius: 1}}
)");
  expect_color(world.trace(Vec3(0.5, 2, 0), Vec3(0, -1, 0)), Color(0));
  EXPECT_GT(world.trace(Vec3(8, 2, 0), Vec3(0, -1, 0)).x, 0.1);
}

TEST(Lighting, MirrorsHaveTheirDepthAndWeightLimits) {
  // Two facing mirrors of .5 with ambient 1: at depth d the sum of 1 + 1/2 + … has d terms.
  World world(test::view_text() + R"(
background: 0
materials: {m: {ambient: 1, diffuse: 0, reflect: 0.5}}
scene:
  - {material: m, polygon: {points: [[-9, 0, 9], [9, 0, 9], [9, 0, -9], [-9, 0, -9]]}}
  - {material: m, polygon: {points: [[-9, 2, 9], [9, 2, 9], [9, 2, -9], [-9, 2, -9]]}}
)");
  for (uint32_t depth = 1; depth <= 6; ++depth) {
    world.settings.max_depth = depth;
    expect_color(world.trace(Vec3(0, 1, 0), Vec3(0, -1, 0)), Color(2 - std::pow(0.5, depth - 1)));
  }
  world.settings.max_depth = 50;
  world.settings.min_weight = 0.2;  // .5 and .25 pass, .125 does not: three terms
  expect_color(world.trace(Vec3(0, 1, 0), Vec3(0, -1, 0)), Color(1.75));
  world.settings.lighting = LightingModel::phong;
  expect_color(world.trace(Vec3(0, 1, 0), Vec3(0, -1, 0)), Color(1));
}

TEST(Lighting, RefractionFollowsSnell) {
  // Through a slab of index 1.5 a ray leaves parallel, shifted; it meets a wall whose colour tells where.
  const double angle = M_PI / 3;  // in air; inside asin(sin 60° / 1.5)
  const double inside = std::asin(std::sin(angle) / 1.5);
  const double x =
      std::tan(angle) + std::tan(inside) + std::tan(angle);  // one unit above, in, and below the slab
  for (const double offset : {-1e-6, 1e-6}) {
    std::string text = test::view_text() + R"(
background: 0
materials:
  glass: {ambient: 0, diffuse: 0, transmit: 1, index: 1.5}
  wall: {ambient: 1, diffuse: 0}
scene:
  - {material: glass, box: {min: [-50, 0, -50], max: [50, 1, 50]}}
  - {material: wall, polygon: {points: [[EDGE, -1, -9], [EDGE, -1, 9], [99, -1, 9], [99, -1, -9]]}}
)";
    const std::string edge = fmt::format("{:.15f}", x + offset);
    for (size_t at; (at = text.find("EDGE")) != std::string::npos;) text.replace(at, 4, edge);
    World edged(text);
    expect_color(edged.trace(Vec3(0, 2, 0), Vec3(std::sin(angle), -std::cos(angle), 0)),
                 Color(offset < 0 ? 1 : 0));
  }
}

TEST(Lighting, TotalInternalReflectionTakesTheTransmittedShare) {
  // From inside glass at 60° (critical angle 41.8°) to a face: all of T goes along the mirror direction.
  World world(test::view_text() + R"(
background: [0.25, 0.5, 1]
materials: {glass: {ambient: 0, diffuse: 0, transmit: 0.9, index: 1.5}}
scene: [{material: glass, polygon: {points: [[-9, 0, 9], [9, 0, 9], [9, 0, -9], [-9, 0, -9]]}}]
)");
  expect_color(world.trace(Vec3(0, -1, 0), Vec3(std::sin(M_PI / 3), std::cos(M_PI / 3), 0)),
               0.9 * Color(0.25, 0.5, 1));
  EXPECT_EQ(world.counts[RayKind::transmitted], 0u);
  EXPECT_EQ(world.counts[RayKind::reflected], 1u);
}

class SceneScale : public testing::TestWithParam<double> {};

TEST_P(SceneScale, NeitherAcneNorLeaks) {
  // Convex bodies lit from the viewer's side: no point that faces the light is shadowed by its own body,
  // whatever the scale, also far from the origin. And inside closed bodies with a light outside nothing is
  // lit.
  const double s = GetParam();
  std::mt19937 random(8);
  for (const double shift : {0.0, 300.0}) {
    SceneDescription scene;
    scene.files = {"acne"};
    scene.materials.emplace_back("m");
    scene.materials[0].ambient = 0;
    scene.materials[0].diffuse = 1;
    scene.objects.push_back({"root", {}, {}, {}});
    const Vec3 at = Vec3(shift, -0.7 * shift, 0.3 * shift) * s;
    scene.objects.push_back({"moved", {}, {}, {}});
    auto& primitives = scene.objects[0].primitives;
    primitives.push_back({SphereShape{at + Vec3(0, 0, 0) * s, s}, 0, {}});
    primitives.push_back(
        {ConeShape{at + Vec3(4, -1, 0) * s, at + Vec3(4, 1, 0.5) * s, 0.8 * s, 0.2 * s}, 0, {}});
    scene.objects[1].primitives.push_back({QuadricShape{{1, 2, 1.5, 0.1, 0, 0, 0, 0, 0, -s * s}, {}}, 0, {}});
    scene.objects[0].children.push_back(
        {1, {{TransformKind::translate, constant_curve(Vec4(at + Vec3(8, 0, 0) * s, 0)), {}, {}}}, {}});
    const Vec3 eye = at + Vec3(4, 1, 30) * s;
    scene.lights.push_back({.position = eye});
    const CompiledScene compiled = compile(scene);
    FrameState frame_pose(compiled.scene);
    const Pose pose = frame_pose.at(0);
    int hits = 0;
    for (int i = 0; i < 20000; ++i) {
      const Vec3 target = at + Vec3(test::uniform(random, -1, 9), test::uniform(random, -1.2, 1.2), 0) * s;
      const Ray ray{eye, normalized(target - eye)};
      const Hit hit = closest_hit(compiled.scene, pose, ray);
      if (!hit.is_hit()) continue;
      ++hits;
      const Surface surface = eval_surface(compiled.scene, pose, ray, hit);
      const Vec3 origin = surface.ray_origin(eye - surface.p);
      EXPECT_FALSE(any_hit(compiled.scene, pose, {origin, eye - origin, 1}))
          << "acne at scale " << s << ", shift " << shift;
      const Vec3 inward = surface.ray_origin(-surface.geometric_normal);
      if (hit.primitive.kind() == PrimitiveKind::sphere) {
        EXPECT_TRUE(any_hit(compiled.scene, pose, {inward, normalized(test::random_point(random, 1))}))
            << "a leak";
      }
      if (HasFailure()) return;
    }
    EXPECT_GT(hits, 5000);
  }
}

INSTANTIATE_TEST_SUITE_P(, SceneScale, testing::Values(1e-3, 1.0, 1e3, 1e6));

TEST(Lighting, MeshesOfAnyScaleShadowThemselvesOnlyWhereTheyShould) {
  for (const double s : {1e-3, 1.0, 1e6}) {
    SceneDescription scene;
    scene.files = {"mesh"};
    scene.materials.emplace_back("m");
    scene.objects.push_back({"root", {}, {}, {}});
    MeshShape mesh;  // a convex octahedron
    for (const Vec3& v :
         {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)})
      mesh.positions.emplace_back(s * (v + Vec3(10, 20, 30)));
    for (const auto& t : {glm::uvec3(0, 2, 4), glm::uvec3(2, 1, 4), glm::uvec3(1, 3, 4), glm::uvec3(3, 0, 4),
                          glm::uvec3(2, 0, 5), glm::uvec3(1, 2, 5), glm::uvec3(3, 1, 5), glm::uvec3(0, 3, 5)})
      mesh.triangles.push_back(t);
    scene.objects[0].primitives.push_back({mesh, 0, {}});
    const CompiledScene compiled = compile(scene);
    FrameState frame_pose(compiled.scene);
    const Pose pose = frame_pose.at(0);
    std::mt19937 random(4);
    const Vec3 center = s * Vec3(10, 20, 30);
    for (int i = 0; i < 5000; ++i) {
      const Vec3 eye = center + s * 5.0 * normalized(test::random_point(random, 1));
      const Ray ray{eye, normalized(center + s * test::random_point(random, 0.4) - eye)};
      const Hit hit = closest_hit(compiled.scene, pose, ray);
      if (!hit.is_hit()) continue;
      const Surface surface = eval_surface(compiled.scene, pose, ray, hit);
      const Vec3 origin = surface.ray_origin(eye - surface.p);
      ASSERT_FALSE(any_hit(compiled.scene, pose, {origin, eye - origin, 1}));
      const Vec3 inside = surface.ray_origin(-surface.geometric_normal);
      ASSERT_TRUE(closest_hit(compiled.scene, pose, {inside, -surface.geometric_normal}).is_hit());
    }
  }
}

TEST(Render, CornersAreSharedAndCountedOnce) {
  const CompiledScene compiled = compile(load_scene(std::string(RAYFARM_SOURCE) + "/scenes/primitives.yaml"));
  RenderSettings settings;
  settings.width_px = settings.height_px = 24;
  settings.crop = {0, 0, 24, 24};
  settings.sampling = SamplingPattern::corners;
  Renderer renderer(compiled.scene, settings);
  const auto render = [&](const PixelRect& rect) { return renderer.render(0, rect, [] {}); };
  const RenderedPixels whole = render(settings.crop);
  EXPECT_EQ(whole.counts[RayKind::primary], 25u * 25u);
  RayCounts sum;
  for (const PixelRect& rect : {PixelRect{0, 0, 10, 24}, PixelRect{10, 0, 24, 9}, PixelRect{10, 9, 24, 24}}) {
    const RenderedPixels part = render(rect);
    sum += part.counts;
    for (int y = rect.y0; y < rect.y1; ++y)
      EXPECT_TRUE(std::equal(part.pixels.begin() + (y - rect.y0) * rect.width() * 6,
                             part.pixels.begin() + (y - rect.y0 + 1) * rect.width() * 6,
                             whole.pixels.begin() + (y * 24 + rect.x0) * 6));
  }
  EXPECT_EQ(sum, whole.counts);
}

TEST(PixelFormat, SrgbThereAndBack) {
  for (int i = 0; i < 256; ++i) EXPECT_EQ(encode_srgb8(decode_srgb8(static_cast<uint8_t>(i))), i);
  EXPECT_EQ(encode_srgb8(-1), 0);
  EXPECT_EQ(encode_srgb8(7), 255);
  EXPECT_EQ(encode_srgb8(std::nan("")), 0);
  EXPECT_EQ(encode_srgb8(0.5), 188);  // IEC 61966-2-1: 1.055 · 0.5^(1/2.4) - 0.055 = 0.7354
}

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
  const CompiledScene compiled = compile(test::load_yaml(R"(
view: {location: {0: [0, 0, 5], 1: [0.2, 0, 5]}, look_at: [0, 0, 0], lens: {radius: 0.1, focus: 5}}
background: 0.4
lights: [{position: [3, 4, 5], color: 0.8}]
materials: {m: {lambertian: [0.7, 0.5, 0.3]}, glass: {dielectric: flint}, lamp: {luminaire: {emission: 3}}}
scene:
  - {material: m, transform: {translate: {0: [-1, 0, 0], 1: [-0.6, 0, 0]}}, sphere: {center: [0, 0, 0], radius: 0.8}}
  - {material: glass, sphere: {center: [0.8, 0, 0.5], radius: 0.7}}
  - {material: lamp, sphere: {center: [0, 1.6, 0], radius: 0.4}}
)"));
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
