// Rays that leave surfaces without an epsilon (Shirley, Sung and Brown 1991, section 3.1 and Figure 5).
#include "common/description/open_objects.h"
#include "common/lighting/renderer.h"
#include "common/lighting/self_hits.h"
#include "common/scene/settings_codec.h"
#include "tests/unit/probe.h"

namespace rayfarm {
namespace {

/// A scene in which single rays are followed by what they are in.
struct Rays : Probe {
  explicit Rays(const std::string& text) : Probe(text) {
    settings.self_hit = SelfHit::medium;
    for (const MaterialDescription& m : test::load_yaml(test::view_text() + text).materials)
      names.push_back(m.name);
  }

  struct Met {
    std::string material;  ///< "": nothing is hit
    Surface surface;
  };
  Met meet(const Vec3& origin, const Vec3& direction, const Media& media) {
    const SamplingTables tables(settings, 0);
    const FrameContext context{compiled.scene, pose, tables};
    const Ray ray{origin, direction};
    const Hit hit = next_real_hit(context, ray, media, closest_hit(compiled.scene, pose, ray));
    if (!hit.is_hit()) return {};
    Met met{"", eval_surface(compiled.scene, pose, ray, hit)};
    met.material = names[met.surface.material];
    return met;
  }
  uint32_t number(const std::string& material) const {
    return static_cast<uint32_t>(std::find(names.begin(), names.end(), material) - names.begin());
  }
  Media in(const std::vector<std::string>& materials) const {
    Media media;
    for (const std::string& material : materials) media.cross(number(material), true);
    return media;
  }
  std::vector<std::string> names;  ///< of the materials, in their order
};

// "…Figure 5, where a ray originates at point P1 and propagates into glass (the outside material). When the
// ray is tested for intersection against S1, the dot product … indicates that the ray is going inside to
// outside and is thus approaching from the water side. Since the [ray] is in glass, we know there can be no
// intersection, so no ε test is needed. For S2, the inside material is glass, so the intersection point P2 is
// taken to be valid."
TEST(SelfHit, Figure5) {
  Rays rays(R"(
materials: {water: {dielectric: {index: 1.33, priority: 1}}, glass: {dielectric: {index: 1.5}}}
scene:
  - {material: water, sphere: {center: [0, 0, 0], radius: 1}}
  - {material: glass, sphere: {center: [0, 0, 0], radius: 2}}
)");
  // P1 may lie on the wrong side of S1, as rounding would have it and farther than any ε.
  for (const double off : {-1e-3, -1e-16, 0.0, 1e-16, 1e-3}) {
    const auto [s2, p2] = rays.meet({0, 0, 1 + off}, {0, 0, 1}, rays.in({"glass"}));
    EXPECT_EQ(s2, "glass");
    EXPECT_NEAR(p2.p.z, 2, 1e-12);
    EXPECT_FALSE(p2.is_front);
    // The other way, into the water, which is left on its far side.
    const auto [s1, far_side] = rays.meet({0, 0, 1 + off}, {0, 0, -1}, rays.in({"glass", "water"}));
    EXPECT_EQ(s1, "water");
    EXPECT_NEAR(far_side.p.z, -1, 1e-12);
  }
}

// "Amanitides and Mitchell showed that problems can arise when there are real surfaces closer than t = ε": a
// core under a glaze thinner than the rounding bound is passed by rays that start off the glaze by the bound,
// and met by those that know what they are in.
TEST(SelfHit, MeetsSurfacesThatAreCloserThanTheRoundingBound) {
  constexpr double kGlaze = 0x1p-46;
  Rays rays(fmt::format(R"(
materials: {{glaze: {{dielectric: {{index: 1.5}}}}, core: {{color: 0.5}}}}
scene:
  - {{material: glaze, sphere: {{center: [0, 0, 0], radius: {:.17g}}}}}
  - {{material: core, sphere: {{center: [0, 0, 0], radius: 1}}}}
)",
                        1 + kGlaze));
  std::mt19937 random(1);
  int met = 0, passed = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec3 direction(test::uniform(random, -0.2, 0.2), test::uniform(random, -0.2, 0.2), -1);
    auto [glaze, surface] = rays.meet({0, 0, 3}, direction, {});
    ASSERT_EQ(glaze, "glaze");
    ASSERT_GT(surface.offset, kGlaze);
    const Ray off{surface.ray_origin(direction), direction};
    const Hit hit = closest_hit(rays.compiled.scene, rays.pose, off);
    passed += hit.is_hit() && !eval_surface(rays.compiled.scene, rays.pose, off, hit).is_front ? 1 : 0;
    Media media;
    surface = laid_on_surface(rays.compiled.scene, surface);
    leave(rays.compiled.scene, surface, direction, media);
    const auto [core, below] = rays.meet(surface.ray_origin(direction), direction, media);
    met += core == "core" && below.is_front ? 1 : 0;
  }
  EXPECT_EQ(met, 200);
  EXPECT_EQ(passed, 200);
}

// "Our translucent surface does not fit this definition, so some care must be taken": it is met from both
// sides by whatever ray, and left by the bound. So is a mix, of which no one material is behind it.
TEST(SelfHit, SheetsAreMetFromBothSides) {
  Rays rays(R"(
materials:
  paper: {translucent: {front: 0.5, through: 0.4}}
  wall: {color: 0.5}
scene:
  - {material: paper, polygon: {points: [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]}}
  - {material: wall, polygon: {points: [[-1, -1, 2], [1, -1, 2], [1, 1, 2], [-1, 1, 2]]}}
)");
  EXPECT_EQ(rays.meet({0, 0, 1}, {0, 0, -1}, {}).material, "paper");
  auto [paper, surface] = rays.meet({0, 0, -1}, {0, 0, 1}, {});
  EXPECT_EQ(paper, "paper");
  surface = laid_on_surface(rays.compiled.scene, surface);
  EXPECT_GT(surface.offset, 0);
  Media media;
  leave(rays.compiled.scene, surface, {0, 0, 1}, media);
  EXPECT_TRUE(media.is_in_air());
}

// What the paper asks for: "we need to maintain an outward facing normal". What is not closed is met from its
// front alone.
TEST(SelfHit, FailsBehindWhatIsNotClosed) {
  Rays rays(R"(
materials: {wall: {color: 0.5}}
scene: [{material: wall, polygon: {points: [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]}}]
)");
  EXPECT_EQ(rays.meet({0, 0, 1}, {0, 0, -1}, {}).material, "wall");
  EXPECT_EQ(rays.meet({0, 0, -1}, {0, 0, 1}, {}).material, "");
}

// "Each surface can be viewed as an interface between two materials": where bodies of one material overlap
// there are surfaces with the same on both sides, and a ray leaves both bodies where it leaves the first.
TEST(SelfHit, FailsWhereBodiesOfOneMaterialOverlap) {
  Rays rays(R"(
materials: {glass: {dielectric: {index: 1.5}}}
scene:
  - {material: glass, sphere: {center: [0, 0, 0.5], radius: 1}}
  - {material: glass, sphere: {center: [0, 0, -0.5], radius: 1}}
)");
  Media media;
  Vec3 p(0, 0, 5);
  std::vector<double> met;
  while (met.size() < 9) {
    auto [material, surface] = rays.meet(p, {0, 0, -1}, media);
    if (material.empty()) break;
    met.push_back(surface.p.z);
    surface = laid_on_surface(rays.compiled.scene, surface);
    leave(rays.compiled.scene, surface, {0, 0, -1}, media);
    p = surface.p;
  }
  ASSERT_EQ(met.size(), 2u);
  EXPECT_NEAR(met[0], 1.5, 1e-12);
  EXPECT_NEAR(met[1], -0.5, 1e-12);  // where both together end at -1.5
}

// "each ray stores the material it is currently in" (2.1): the eye's rays from the first on.
TEST(SelfHit, TheEyeKnowsWhatItIsIn) {
  Rays rays(R"(
materials: {wall: {color: 0.5}, water: {dielectric: {index: 1.33}}, ball: {color: 0.3}}
scene:
  - {material: wall, sphere: {center: [0, 0, 0], radius: 9}}
  - {material: water, sphere: {center: [0, 0, 0], radius: 2}}
  - {material: ball, sphere: {center: [0, 0, -1], radius: 0.5}}
)");
  const auto eye_at = [&](const Vec3& p) {
    return find_eye_media(rays.compiled.scene, rays.pose, Ray{p, {0, 0, -1}});
  };
  const Media in_water = eye_at({0, 0, 1}), in_room = eye_at({0, 0, 3}), outside = eye_at({0, 0, 10});
  EXPECT_TRUE(in_water.contains(rays.number("water")));
  EXPECT_TRUE(in_water.contains(rays.number("wall")));
  EXPECT_FALSE(in_water.contains(rays.number("ball")));
  EXPECT_EQ(in_water.current(rays.compiled.scene), rays.number("water"));
  EXPECT_FALSE(in_room.contains(rays.number("water")));
  EXPECT_TRUE(in_room.contains(rays.number("wall")));
  EXPECT_EQ(in_room.current(rays.compiled.scene), kNone);  // an opaque body is no medium that bends light
  EXPECT_TRUE(outside.is_in_air());
}

/// Bodies that are closed, in a room whose walls enclose what is outside of it.
std::string closed_bodies(double scale, const Vec3& at) {
  std::string text = R"(
ambient: 0.3
lights: [{position: [0.5, 0.75, 0.5], color: 0.9}]
materials:
  wall: {color: [0.8, 0.5, 0.4], ambient: 0.7, diffuse: 0.7}
  mirror: {color: 0.9, ambient: 0.2, diffuse: 0.2, specular: 0.5, shininess: 20, reflect: 0.6}
  glass: {color: 0.9, ambient: 0.1, diffuse: 0.1, transmit: 0.8, index: 1.5}
  crystal: {dielectric: {index: 1.5, filter: [0.5, 0.9, 0.9]}}
  lamp: {luminaire: {emission: 3}}
objects:
  all:
    - {material: mirror, sphere: {center: [-0.375, -0.5, -0.25], radius: 0.375}}
    - {material: glass, sphere: {center: [0.375, -0.5, 0.25], radius: 0.25}}
    - {material: lamp, sphere: {center: [-0.5, 0.5, -0.5], radius: 0.125}}
    - {material: crystal, polygons: {points: [[-0.25, -0.75, 0.25], [0, -0.75, 0.25], [0, -0.75, 0.5],
        [-0.25, -0.75, 0.5], [-0.25, -0.25, 0.25], [0, -0.25, 0.25], [0, -0.25, 0.5], [-0.25, -0.25, 0.5]],
        faces: [[0, 1, 2, 3], [4, 7, 6, 5], [0, 4, 5, 1], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 4, 0]]}}
)";
  std::string line;
  for (std::istringstream walls(room("wall")); std::getline(walls, line);) text += "  " + line + "\n";
  const auto numbers = [](const Vec3& v) {
    return fmt::format("[{:.17g}, {:.17g}, {:.17g}]", v.x, v.y, v.z);
  };
  const size_t light = text.find("[0.5, 0.75, 0.5]");
  text.replace(light, 16, numbers(at + scale * Vec3(0.5, 0.75, 0.5)));
  return fmt::format("view: {{location: {}, look_at: {}, field_of_view: 70}}\n",
                     numbers(at + scale * Vec3(0.25, 0.25, 0.9375)),
                     numbers(at + scale * Vec3(0, -0.25, 0))) +
         text +
         fmt::format("scene: [{{use: all, transform: [{{scale: {:.17g}}}, {{translate: {}}}]}}]\n", scale,
                     numbers(at));
}

// "we can eliminate the ε test": pictures of closed bodies are those of rays that start off surfaces by a
// bound, at any scale and place; where they are not, within a pixel's noise, a ray met an edge otherwise.
TEST(SelfHit, PicturesOfClosedBodiesAreThoseByTheBound) {
  struct Case {
    double scale;
    Vec3 at;
  };
  for (const auto& [scale, at] :
       {Case{1, {0, 0, 0}}, Case{1e-6, {0, 0, 0}}, Case{1e6, {0, 0, 0}}, Case{1, {131072, -65536, 32768}}}) {
    const CompiledScene compiled = compile(test::load_yaml(closed_bodies(scale, at)));
    for (const LightingModel model :
         {LightingModel::phong, LightingModel::whitted, LightingModel::thesis, LightingModel::path}) {
      SCOPED_TRACE(fmt::format("scale {} at {}, model {}", scale, at.x, static_cast<int>(model)));
      RenderSettings settings = test::picture_settings(28, 21, model);
      limit_by_depth(settings, model == LightingModel::thesis ? 3 : 6);
      settings.diffuse_rays = 2;
      settings.glass_shadows = GlassShadows::transparent;
      std::array<std::vector<float>, 2> pictures;
      for (const SelfHit self_hit : {SelfHit::bound, SelfHit::medium}) {
        settings.self_hit = self_hit;
        const RenderedPixels rendered = Renderer(compiled.scene, settings).render(0, settings.crop, [] {});
        std::vector<float>& picture = pictures[static_cast<size_t>(self_hit)];
        picture.resize(rendered.pixels.size() / sizeof(float));
        std::memcpy(picture.data(), rendered.pixels.data(), rendered.pixels.size());
      }
      size_t differ = 0;
      std::array<double, 2> sums{};
      for (size_t i = 0; i < pictures[0].size(); ++i) {
        const double a = pictures[0][i], b = pictures[1][i];
        if (std::abs(a - b) > 1e-4 * (a + b)) ++differ;
        sums[0] += a;
        sums[1] += b;
      }
      EXPECT_GT(sums[0], 0);
      EXPECT_LT(static_cast<double>(differ) / static_cast<double>(pictures[0].size()), 0.01);
      EXPECT_NEAR(sums[1] / sums[0], 1, 0.002);
    }
  }
}

std::vector<std::string> open_objects(const std::string& objects) {
  const SceneDescription scene = test::load_yaml(test::view_text() + R"(
materials: {wall: {color: 0.5}, paper: {translucent: {front: 0.5, through: 0.4}}}
objects:
)" + objects + "scene: []\n");
  std::vector<std::string> names;
  for (const uint32_t object : find_open_objects(scene)) names.push_back(scene.objects[object].name);
  return names;
}

// "we need to maintain an outward facing normal": what has none is named.
TEST(SelfHit, NamesWhatIsNotClosed) {
  const std::string corners = "points: [[0,0,0],[1,0,0],[1,0,1],[0,0,1],[0,1,0],[1,1,0],[1,1,1],[0,1,1]]";
  const auto box = [&](const std::string& name, const std::string& last) {
    return fmt::format(
        "  {}: [{{material: wall, polygons: {{{}, faces: [[0,1,2,3],[4,7,6,5],[0,4,5,1],"
        "[1,5,6,2],[2,6,7,3]{}]}}}}]\n",
        name, corners, last);
  };
  EXPECT_EQ(open_objects(box("whole", ",[3,7,4,0]") + box("open", "") + box("turned", ",[0,4,7,3]")),
            (std::vector<std::string>{"open", "turned"}));
  const std::string square = "polygon: {points: [[0,0,0],[1,0,0],[1,1,0],[0,1,0]]}";
  EXPECT_EQ(
      open_objects("  floor: [{material: wall, " + square + "}]\n  screen: [{material: paper, " + square +
                   "}]\n  ball: [{material: wall, sphere: {center: [0,0,0], radius: 1}}]\n" +
                   "  pipe: [{material: wall, cone: {base: [0,0,0], apex: [0,1,0], base_radius: 1}}]\n" +
                   "  tetra:\n    - {material: wall, polygon: {points: [[0,0,0],[0,1,0],[1,0,0]]}}\n" +
                   "    - {material: wall, polygon: {points: [[0,0,0],[1,0,0],[0,0,1]]}}\n" +
                   "    - {material: wall, polygon: {points: [[0,0,0],[0,0,1],[0,1,0]]}}\n" +
                   "    - {material: wall, polygon: {points: [[1,0,0],[0,1,0],[0,0,1]]}}\n"),
      (std::vector<std::string>{"floor", "pipe"}));
}

TEST(SelfHit, SettingsCarryIt) {
  RenderSettings settings;
  settings.self_hit = SelfHit::medium;
  EXPECT_EQ(decode_settings(encode_settings(settings)).self_hit, SelfHit::medium);
  settings.self_hit = static_cast<SelfHit>(2);
  EXPECT_THROW(check_settings(settings), SettingsError);
}

}  // namespace
}  // namespace rayfarm
