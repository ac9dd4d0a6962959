// Item buffers of the eye and of lights (Weghorst, Hooper and Greenberg 1984, sections 4 and 6), and the
// depth of ray trees that makes the eye's worth while.
#include "common/hierarchy/traverser.h"
#include "common/lighting/item_buffers.h"
#include "common/lighting/renderer.h"
#include "common/scene/settings_codec.h"
#include "tests/deforming_scene.h"
#include "tests/unit/probe.h"

namespace rayfarm {
namespace {

const std::array kScenes{"beach_house", "primitives", "plant",  "pencils_1", "pencils_2",
                         "pencils_3",   "polygons",   "camera", "office",    "pool_room"};

SceneDescription load(const std::string& name) {
  return load_scene(std::string(RAYFARM_SOURCE) + "/scenes/hierarchies/" + name + ".yaml");
}

const std::array<BuildOptions, 2> kBuilds{BuildOptions{}, BuildOptions{.hierarchy = Hierarchy::object}};

bool is_same(const Hit& a, const Hit& b) {
  return a.t == b.t && a.instance == b.instance && a.primitive == b.primitive && a.u == b.u && a.v == b.v;
}

/// How many corners' items are not what a ray through the corner hits.
struct Corners {
  size_t wrong = 0, hit = 0, all = 0;
};
Corners compare_corners(const Scene& scene, int frame, const RenderSettings& settings) {
  FrameState state(scene);
  const Pose pose = state.at(frame);
  const Camera camera = make_camera(scene, frame, settings.width_px, settings.height_px);
  EyeItems items(scene, pose, camera, settings);
  Corners corners;
  for (int y = 0; y <= settings.height_px; ++y)
    for (int x = 0; x <= settings.width_px; ++x) {
      const Ray ray = camera.ray(x, y);
      const Hit expected = closest_hit_brute_force(scene, pose, ray);
      const EyeItems::Candidates& found = items.candidates_at(x, y);
      EXPECT_TRUE(found.is_known);
      EXPECT_LE(found.items.size(), 1u);
      EXPECT_EQ(found.is_open, found.items.empty());
      const Hit hit = closest_hit_among(scene, pose, found.items, ray);
      corners.wrong += is_same(hit, expected) ? 0 : 1;
      corners.hit += expected.is_hit() ? 1 : 0;
      ++corners.all;
    }
  return corners;
}

// Section 4: "This index is simply the indirect storage of the identical information that would have been
// produced by the ray tracer at this level." Where two items are equally near, within the rounding of a
// float, either may stand there.
TEST(ItemBuffer, HoldsAtCornersWhatRaysThroughThemHit) {
  const RenderSettings settings = test::picture_settings(32, 30, LightingModel::whitted);
  for (const char* name : kScenes) {
    const SceneDescription description = load(name);
    for (const BuildOptions& build : kBuilds) {
      SCOPED_TRACE(fmt::format("{} {}", name, kHierarchyWords[static_cast<size_t>(build.hierarchy)]));
      const Corners corners =
          compare_corners(compile(description, build).scene, description.frames ? 2 : 0, settings);
      EXPECT_LE(corners.wrong, corners.all / 200);
      EXPECT_GT(corners.hit, 100u);
    }
  }
}

// Triangles behind the eye, through its plane and around it, and every other kind of primitive.
TEST(ItemBuffer, HoldsWhatIsSeenFromAmidstEverything) {
  for (uint32_t seed = 1; seed <= 4; ++seed)
    for (const BuildOptions& build : kBuilds) {
      const CompiledScene compiled = compile(test::make_mixed_scene(seed, 2, 150), build);
      EXPECT_LE(
          compare_corners(compiled.scene, 0, test::picture_settings(40, 30, LightingModel::whitted)).wrong,
          2u);
    }
}

// Nothing may be read or written outside of the map, whatever the numbers.
TEST(ItemBuffer, OddViewsShowNothingOrSomething) {
  const CompiledScene compiled = compile(test::make_mixed_scene(7, 1e30, 60));
  FrameState state(compiled.scene);
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinite = std::numeric_limits<double>::infinity();
  const ViewPoints points{-3, 2, 9, 11};
  for (const double odd : {0.0, 1e-300, 1e300, infinite, nan})
    for (const ItemView& view :
         {ItemView{Vec3(odd), Vec3(-1, -1, 1), Vec3(0.2, 0, 0), Vec3(0, 0.2, 0), points},
          ItemView{Vec3(1), Vec3(-1, -1, odd), Vec3(0.2, 0, 0), Vec3(0, 0.2, 0), points},
          ItemView{Vec3(1), Vec3(-1, -1, 1), Vec3(odd, 0, 0), Vec3(0, 0.2, 0), points}}) {
      const ItemMap map(compiled.scene, state.at(0), view);
      for (int y = points.y0; y < points.y1; ++y)
        for (int x = points.x0; x < points.x1; ++x)
          ASSERT_EQ(map(x, y).inverse_depth > 0, map(x, y).item.is_there());
      EXPECT_FALSE(map.has(-4, 2));
      EXPECT_FALSE(map.has(-3, 11));
    }
}

RenderedPixels render(const Scene& scene, const RenderSettings& settings, int frame = 0) {
  return Renderer(scene, settings).render(frame, settings.crop, [] {});
}

TEST(ItemBuffer, PicturesStayAsTheyAreWithItsHitsAsBounds) {
  for (const char* name : kScenes) {
    const SceneDescription description = load(name);
    const int frame = description.frames ? 3 : 0;
    for (const BuildOptions& build : kBuilds) {
      SCOPED_TRACE(fmt::format("{} {}", name, kHierarchyWords[static_cast<size_t>(build.hierarchy)]));
      const CompiledScene compiled = compile(description, build);
      for (const SamplingPattern sampling : {SamplingPattern::sobol, SamplingPattern::corners}) {
        RenderSettings settings = test::picture_settings(20, 18, LightingModel::whitted);
        settings.sampling = sampling;
        const RenderedPixels without = render(compiled.scene, settings, frame);
        settings.item_buffer = ItemBuffer::bound;
        settings.light_cells = 40;
        const RenderedPixels with = render(compiled.scene, settings, frame);
        EXPECT_EQ(with.pixels, without.pixels);
        EXPECT_EQ(with.counts.by_kind, without.counts.by_kind);
        EXPECT_EQ(without.counts[RayTally::eye_items] + without.counts[RayTally::shadow_items], 0u);
        if (std::string(name) != "polygons") {
          EXPECT_GT(with.counts[RayTally::eye_items], 150u);
          EXPECT_LE(with.counts[RayTally::eye_items], with.eye_hits);
        }
      }
    }
  }
}

// All lighting models, adaptive samples, cuts, spectra and things that move from frame to frame.
TEST(ItemBuffer, PicturesStayAsTheyAreInEveryModel) {
  const std::string scenes = std::string(RAYFARM_SOURCE) + "/scenes/";
  const auto expect_same = [](const Scene& scene, RenderSettings settings, int frame) {
    const RenderedPixels without = render(scene, settings, frame);
    settings.item_buffer = ItemBuffer::bound;
    settings.light_cells = 64;
    const RenderedPixels with = render(scene, settings, frame);
    EXPECT_EQ(with.pixels, without.pixels);
    EXPECT_GT(with.counts[RayTally::eye_items], 0u);
    RayCounts sum;
    for (const PixelRect& rect : {PixelRect{0, 0, 7, 12}, PixelRect{7, 0, 16, 12}})
      sum += Renderer(scene, settings).render(frame, rect, [] {}).counts;
    EXPECT_EQ(sum, with.counts);
  };
  const CompiledScene still = compile(load_scene(scenes + "primitives.yaml"));
  for (const LightingModel model : {LightingModel::phong, LightingModel::torrance_sparrow,
                                    LightingModel::whitted, LightingModel::thesis, LightingModel::path}) {
    RenderSettings settings = test::picture_settings(16, 12, model);
    settings.samples = 2;
    expect_same(still.scene, settings, 0);
    if (model == LightingModel::path) continue;
    settings.adaptive_contrast = 0.05;
    settings.colour = ColourModel::meyer4;
    expect_same(still.scene, settings, 0);
  }
  Probe moving(R"(
lights: [{position: [3, 4, 5]}, {direction: [0, -1, 0.2]}]
scene:
  - {polygon: {points: [[-9, -1, 9], [9, -1, 9], [9, -1, -9], [-9, -1, -9]]}}
  - {transform: [{translate: {0: [0, 0, 0], 4: [2, 0, 0]}}], sphere: {center: [0, 0, 0], radius: 0.7}}
)");
  for (const int frame : {0, 3})
    expect_same(moving.compiled.scene, test::picture_settings(16, 12, LightingModel::whitted), frame);
}

// Section 4: "If a ray passes through the corner of some pixel, then it is assumed to hit the item that has
// been deemed visible by the preprocess", and with subdivision "the abbreviated intersection list used by the
// ray tracer contains those item indices lying within a desired radius of the sample location".
TEST(ItemBuffer, TrustedItemsAreCheckedRayByRay) {
  const CompiledScene compiled = compile(load("pencils_1"), kBuilds[1]);
  RenderSettings settings = test::picture_settings(64, 60, LightingModel::phong);
  settings.sampling = SamplingPattern::corners;
  const RenderedPixels ordinary = render(compiled.scene, settings);
  const auto with = [&](ItemBuffer use) {
    settings.item_buffer = use;
    return render(compiled.scene, settings);
  };
  EXPECT_EQ(with(ItemBuffer::trusted).pixels, with(ItemBuffer::checked).pixels);
  const RayCounts corners = with(ItemBuffer::checked).counts;
  EXPECT_LE(corners[RayTally::differing], 8u);  // where items touch
  if (corners[RayTally::differing] == 0) {
    EXPECT_EQ(with(ItemBuffer::trusted).pixels, ordinary.pixels);
  }
  EXPECT_GT(corners[RayTally::eye_items], 3000u);
  // Within pixels an item that no corner shows may be missed: the less, the wider the radius.
  settings.sampling = SamplingPattern::sobol;
  settings.item_radius_px = 0.75;
  const uint64_t narrow = with(ItemBuffer::checked).counts[RayTally::differing];
  settings.item_radius_px = 4;
  const uint64_t wide = with(ItemBuffer::checked).counts[RayTally::differing];
  EXPECT_GT(narrow, 0u);
  EXPECT_LT(wide, narrow);
  EXPECT_EQ(with(ItemBuffer::bound).pixels, with(ItemBuffer::none).pixels);
}

TEST(ItemBuffer, IsNotThereThroughALensOrForWhatIsBlurred) {
  const auto expect_none = [](const std::string& text, double shutter) {
    const CompiledScene compiled = compile(test::load_yaml(text));
    RenderSettings settings = test::picture_settings(12, 12, LightingModel::whitted);
    settings.shutter = shutter;
    settings.item_buffer = ItemBuffer::trusted;
    settings.light_cells = shutter > 0 ? 16 : 0;
    EXPECT_FALSE(has_one_eye(compiled.scene, settings));
    const RenderedPixels with = render(compiled.scene, settings);
    EXPECT_EQ(with.counts[RayTally::eye_items] + with.counts[RayTally::shadow_items], 0u);
    settings.item_buffer = ItemBuffer::none;
    settings.light_cells = 0;
    EXPECT_EQ(with.pixels, render(compiled.scene, settings).pixels);
  };
  const std::string ball =
      "scene: [{sphere: {center: [0, 0, 0], radius: 1}}]\nlights: [{position: [1, 2, 9]}]\n";
  expect_none("view: {location: [0, 0, 5], look_at: [0, 0, 0], lens: {radius: 0.2, focus: 5}}\n" + ball, 0);
  expect_none("view: {location: {0: [0, 0, 5], 1: [1, 0, 5]}, look_at: [0, 0, 0]}\n" + ball, 0.5);
}

// Section 6: "Further work must include the extension of the item buffer concept to individual light
// sources".
TEST(LightItems, TellOfTheSameShadowsAsASearch) {
  for (const char* name : {"pencils_3", "office", "pool_room"})
    for (const BuildOptions& build : kBuilds) {
      SCOPED_TRACE(name);
      const CompiledScene compiled = compile(load(name), build);
      const Scene& scene = compiled.scene;
      FrameState state(scene);
      const Pose pose = state.at(0);
      const LightItems items(scene, pose, 128);
      const Camera camera = make_camera(scene, 0, 64, 60);
      std::mt19937 random(5);
      RayCounts counts;
      uint64_t shadows = 0;
      for (int round = 0; round < 300; ++round) {
        const auto light = static_cast<uint32_t>(round) % static_cast<uint32_t>(scene.lights.size());
        RayPacket rays;
        while (!rays.is_full()) {
          // From points of surfaces, as shadow rays come.
          const double x = test::uniform(random, 0, 64);
          const Ray ray = camera.ray(x, test::uniform(random, 0, 60));
          const Hit hit = closest_hit(scene, pose, ray);
          const Vec3 p = ray.origin + (hit.is_hit() ? 0.999 * hit.t : 1) * ray.direction;
          rays.push_back(p, pose[scene.lights[light]].position - p, 1);
        }
        const uint32_t among = 0xff & ~(1u << (round % 8)), expected = any_hits(scene, pose, rays, among);
        ASSERT_EQ(items.blocked(scene, pose, light, rays, among, counts), expected);
        shadows += static_cast<uint64_t>(std::popcount(expected));
      }
      // Many shadows are found by what is nearest to the light.
      EXPECT_GT(shadows, 100u);
      EXPECT_GT(counts[RayTally::shadow_items], shadows / 4);
      EXPECT_LE(counts[RayTally::shadow_items], shadows);
    }
}

// A sun, lights inside and outside of the scene, a spot; bodies and environments have no one point.
TEST(LightItems, EveryPointIsSeenFromLightsThatHaveAPlace) {
  const std::string text = R"(
lights:
  - {position: [0, 0.5, 0]}
  - {position: [40, 60, 50]}
  - {position: [0, 3, 1], direction: [0, -1, 0], angle: 50}
  - {direction: [0.3, -1, 0.2]}
materials: {lamp: {luminaire: {emission: [5, 5, 5]}}}
scene:
  - {material: lamp, sphere: {center: [0, 5, 0], radius: 0.2}}
  - {sphere: {center: [0, 0, 0], radius: 0.3}}
  - {sphere: {center: [1, 0, 0], radius: 0.3}}
  - {sphere: {center: [0, 1, 0], radius: 0.3}}
  - {polygon: {points: [[-3, -1, 3], [3, -1, 3], [3, -1, -3], [-3, -1, -3]]}}
)";
  const CompiledScene compiled = compile(test::load_yaml(test::view_text() + text));
  EXPECT_EQ(std::count_if(compiled.scene.lights.begin(), compiled.scene.lights.end(), has_item_map), 4);
  RenderSettings settings = test::picture_settings(40, 40, LightingModel::whitted);
  const RenderedPixels without = render(compiled.scene, settings);
  for (const uint32_t cells : {2u, 64u, 500u}) {
    settings.light_cells = cells;
    const RenderedPixels with = render(compiled.scene, settings);
    EXPECT_EQ(with.pixels, without.pixels);
    if (cells == 64) {
      EXPECT_GT(with.counts[RayTally::shadow_items], 50u);
    }
  }
  EXPECT_EQ(LightItems::most_lights(kMostLightCells), 1u);
}

// Thesis 2.3.4 and Weghorst, section 1: the weight of a ray is its parent's times a coefficient. Between two
// facing mirrors of .5 the weights .5 and .25 pass .2, and .125 does not: every tree is three deep, and ends
// in a cut.
TEST(RayTrees, TheirDepthAndWhatWasCutIsCounted) {
  Probe world(R"(
materials: {m: {ambient: 1, diffuse: 0, reflect: 0.5}}
scene:
  - {material: m, polygon: {points: [[-9, 0, 9], [9, 0, 9], [9, 0, -9], [-9, 0, -9]]}}
  - {material: m, polygon: {points: [[-9, 2, 9], [9, 2, 9], [9, 2, -9], [-9, 2, -9]]}}
)");
  for (const LightingModel model : {LightingModel::whitted, LightingModel::thesis}) {
    world.counts = {};
    world.settings.lighting = model;
    limit_by_depth(world.settings, 50);
    world.settings.min_weight = 0.2;
    world.mean(Vec3(0, 1, 0), Vec3(0, -1, 0), 5);
    EXPECT_EQ(world.counts[RayTally::cut], 5u);
    EXPECT_EQ(world.counts.average_depth(), 3);
    world.counts = {};
    limit_by_depth(world.settings, 2);
    world.mean(Vec3(0, 1, 0), Vec3(0, -1, 0), 5);
    EXPECT_EQ(world.counts[RayTally::cut], 0u);  // it is the depth that ends these
    EXPECT_EQ(world.counts.average_depth(), 2);
  }
  world.counts = {};
  world.settings.lighting = LightingModel::phong;
  world.mean(Vec3(0, 1, 0), Vec3(0, -1, 0), 5);
  EXPECT_EQ(world.counts.average_depth(), 1);
  world.counts = {};
  world.settings.lighting = LightingModel::path;
  limit_by_depth(world.settings, 3);
  world.mean(Vec3(0, 1, 0), Vec3(0, -1, 0), 64);
  EXPECT_GE(world.counts.average_depth(), 1);
  EXPECT_LE(world.counts.average_depth(), 3);
  EXPECT_EQ(world.counts[RayTally::tree_depth],
            world.counts[RayKind::primary] + world.counts[RayKind::reflected]);
}

TEST(ItemBuffer, ServesWhatTheFrameHasReshapedAndBuiltAnew) {
  const CompiledScene compiled = compile(test::make_scrambled(40, 16));
  DeformedParts parts(compiled.scene);
  parts.set(10);
  ASSERT_GT(parts.builds(), 0u);
  RenderSettings settings = test::picture_settings(48, 36, LightingModel::whitted);
  limit_by_depth(settings, 3);
  const auto picture = [&](ItemBuffer buffer, double shutter) {
    settings.item_buffer = buffer;
    settings.light_cells = buffer == ItemBuffer::none ? 0 : 8;
    settings.shutter = shutter;
    Renderer renderer(compiled.scene, settings);
    renderer.render(0, settings.crop, [] {});  // it has seen another tree
    return renderer.render(10, settings.crop, [] {}).pixels;
  };
  EXPECT_EQ(picture(ItemBuffer::bound, 0), picture(ItemBuffer::none, 0));
  // With several moments, each of its own shape, there is no one buffer.
  settings.samples = 4;
  settings.shutter = 1;
  EXPECT_FALSE(has_one_eye(compiled.scene, settings));
  EXPECT_EQ(picture(ItemBuffer::trusted, 1), picture(ItemBuffer::none, 1));
}

TEST(ItemBuffer, SettingsOutOfRangeAreRefused) {
  const auto is_refused = [](auto change) {
    RenderSettings settings;
    change(settings);
    try {
      decode_settings(encode_settings(settings));
    } catch (const SettingsError&) {
      return true;
    }
    return false;
  };
  EXPECT_FALSE(is_refused([](RenderSettings& s) {
    s.item_buffer = ItemBuffer::checked;
    s.item_radius_px = 8;
    s.light_cells = kMostLightCells;
  }));
  EXPECT_TRUE(is_refused([](RenderSettings& s) { s.item_buffer = static_cast<ItemBuffer>(4); }));
  EXPECT_TRUE(is_refused([](RenderSettings& s) { s.item_radius_px = 0.7; }));
  EXPECT_TRUE(is_refused([](RenderSettings& s) { s.item_radius_px = std::nan(""); }));
  EXPECT_FALSE(is_refused([](RenderSettings& s) { s.samples = kMostSamples; }));
  EXPECT_TRUE(is_refused([](RenderSettings& s) { s.samples = kMostSamples + 1; }));
  EXPECT_TRUE(is_refused([](RenderSettings& s) { s.light_cells = 1; }));
  EXPECT_TRUE(is_refused([](RenderSettings& s) { s.light_cells = kMostLightCells + 1; }));
  EXPECT_TRUE(is_refused([](RenderSettings& s) {
    s.width_px = s.height_px = 65536;
    s.crop = {0, 0, 65536, 65536};
    s.item_buffer = ItemBuffer::bound;
  }));
}

}  // namespace
}  // namespace rayfarm
