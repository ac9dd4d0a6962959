// The hierarchy against brute force, on every SIMD target that this machine can run.
#include "common/hierarchy/traverser.h"

#include "common/hierarchy/walk_counts.h"
#include "tests/unit/simd_targets.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

Ray random_ray(std::mt19937& random, double scale) {
  const Vec3 origin = test::random_point(random, 2 * scale);
  Vec3 direction = test::random_point(random, 1);
  const uint32_t kind = random() % 8;
  const auto zero = [&] { return random() % 2 ? 0.0 : -0.0; };
  if (kind == 0) direction = Vec3(zero(), zero(), random() % 2 ? 1 : -1);  // along an axis
  if (kind == 1) direction.x = zero();                                     // in a plane
  return {origin, normalized(direction)};
}

/// As many rays as make a packet: neighbours, strangers, or some with zeros of either sign.
std::vector<Ray> random_packet(std::mt19937& random, double scale) {
  std::vector<Ray> rays;
  const Ray first = random_ray(random, scale);
  const uint32_t kind = random() % 4;
  const size_t size = 1 + random() % kMostPacketRays;
  for (size_t i = 0; i < size; ++i) {
    Ray ray = kind == 0 ? random_ray(random, scale) : first;
    if (kind == 1) ray.direction += test::random_point(random, 0.02);
    if (kind == 2) ray.origin += test::random_point(random, 0.1 * scale);
    if (kind == 3) ray.direction.y = random() % 2 ? 0.0 : -0.0;
    if (random() % 4 == 0) ray.t_max = scale;
    rays.push_back(ray);
  }
  return rays;
}

void expect_same(const Hit& a, const Hit& b) {
  EXPECT_EQ(a.is_hit(), b.is_hit());
  if (!a.is_hit() || !b.is_hit()) return;
  EXPECT_EQ(a.t, b.t);
  EXPECT_EQ(a.instance, b.instance);
  EXPECT_EQ(a.primitive, b.primitive);
}

void compare_with_brute_force(const CompiledScene& compiled, double scale, int rays) {
  FrameState frame_pose(compiled.scene);
  const Pose pose = frame_pose.at(0);
  std::mt19937 random(7);
  int hits = 0;
  for (int i = 0; i < rays; ++i) {
    Ray ray = random_ray(random, scale);
    const Hit slow = closest_hit_brute_force(compiled.scene, pose, ray);
    expect_same(closest_hit(compiled.scene, pose, ray), slow);
    EXPECT_EQ(any_hit(compiled.scene, pose, ray), slow.is_hit());
    hits += slow.is_hit() ? 1 : 0;
    if (slow.is_hit()) {  // nothing lies in front of the closest hit
      ray.t_max = slow.t;
      EXPECT_FALSE(any_hit(compiled.scene, pose, ray));
    }
    if (testing::Test::HasFailure()) FAIL() << "ray " << i;
  }
  EXPECT_GT(hits, 30);
}

void compare_packets_with_single_rays(const CompiledScene& compiled, double scale, int packets) {
  FrameState frame_pose(compiled.scene);
  const Pose pose = frame_pose.at(0);
  std::mt19937 random(8);
  for (int n = 0; n < packets; ++n) {
    const std::vector<Ray> rays = random_packet(random, scale);
    std::array<Hit, kMostPacketRays> hits;
    closest_hits(compiled.scene, pose, RayPacket(rays), hits.data());
    const uint32_t any = any_hits(compiled.scene, pose, RayPacket(rays));
    EXPECT_EQ(any >> rays.size(), 0u);
    // Some of a packet's lanes, wherever they are; what lies in the others changes nothing.
    RayPacket with_gaps;
    with_gaps.size = kMostPacketRays;
    const uint32_t among = random() % 256 & RayPacket(rays).all();
    for (size_t i = 0; i < kMostPacketRays; ++i) {
      const double no_number = std::numeric_limits<double>::quiet_NaN();
      if (among >> i & 1)
        with_gaps.set(i, rays[i].origin, rays[i].direction, rays[i].t_max);
      else
        with_gaps.set(i, Vec3(no_number), Vec3(no_number), no_number);
    }
    EXPECT_EQ(any_hits(compiled.scene, pose, with_gaps, among), any & among);
    EXPECT_EQ(any_hits(compiled.scene, pose, with_gaps, 0), 0u);
    for (size_t i = 0; i < rays.size(); ++i) {
      const Hit single = closest_hit(compiled.scene, pose, rays[i]);
      expect_same(hits[i], single);
      EXPECT_EQ(hits[i].u, single.u);
      EXPECT_EQ(any >> i & 1, any_hit(compiled.scene, pose, rays[i]) ? 1u : 0u);
      if (testing::Test::HasFailure()) FAIL() << "packet " << n << ", ray " << i;
    }
  }
}

class Scales : public testing::TestWithParam<double> {};

TEST_P(Scales, MixedSceneAgreesWithBruteForce) {
  const CompiledScene compiled = compile(test::make_mixed_scene(3, GetParam(), 400));
  compare_with_brute_force(compiled, GetParam(), 4000);
  compare_packets_with_single_rays(compiled, GetParam(), 2000);
}

INSTANTIATE_TEST_SUITE_P(, Scales, testing::Values(1e-3, 1.0, 1e6));

TEST(Traverser, EverySplitRuleAndLeafSize) {
  for (const BuildOptions& options :
       {BuildOptions{Hierarchy::thesis, 1}, BuildOptions{Hierarchy::thesis, 30},
        BuildOptions{.hierarchy = Hierarchy::thesis, .thesis = {ThesisVolumes::spheres, ThesisClip::always}},
        BuildOptions{Hierarchy::sah, 1}, BuildOptions{Hierarchy::sah, 30}})
    compare_with_brute_force(compile(test::make_mixed_scene(4, 1, 300), options), 1, 1500);
}

class Hierarchies : public testing::TestWithParam<Hierarchy> {};

TEST_P(Hierarchies, AnswerAsBruteForceDoes) {
  for (const double scale : {1e-3, 1.0, 1e6}) {
    const CompiledScene compiled =
        compile(test::make_mixed_scene(4, scale, 100), {.hierarchy = GetParam(), .max_primitives = 4});
    compare_with_brute_force(compiled, scale, 500);
    compare_packets_with_single_rays(compiled, scale, 300);
  }
}

INSTANTIATE_TEST_SUITE_P(, Hierarchies,
                         testing::Values(Hierarchy::sah, Hierarchy::thesis, Hierarchy::regular,
                                         Hierarchy::adaptive, Hierarchy::brute, Hierarchy::object));

TEST(Traverser, CountedWalksAnswerAsOthersAndCountWhatTheyVisit) {
  const SceneDescription description = test::make_mixed_scene(6, 1, 400);
  WalkCounts of_volumes, of_list;
  for (const bool is_list : {false, true}) {
    const CompiledScene compiled =
        compile(description, {.hierarchy = is_list ? Hierarchy::brute : Hierarchy::sah});
    FrameState state(compiled.scene);
    const Pose pose = state.at(0);
    std::mt19937 random(22);
    for (int i = 0; i < 300; ++i) {
      const Ray ray{test::random_point(random, 2), normalized(test::random_point(random, 1))};
      WalkCounts counts;
      expect_same(closest_hit_counted(compiled.scene, pose, ray, counts),
                  closest_hit(compiled.scene, pose, ray));
      EXPECT_EQ(any_hit_counted(compiled.scene, pose, ray, is_list ? of_list : of_volumes),
                any_hit(compiled.scene, pose, ray));
      if (!is_list) continue;
      const Part& part = compiled.scene.parts[0];
      ASSERT_EQ(part.collection.structure, Structure::list);
      EXPECT_EQ(counts.nodes, 0u);
      EXPECT_EQ(counts.leaves, 3u);
      EXPECT_EQ(counts.spheres, part.sphere_count);
      EXPECT_EQ(counts.polygons, part.polygon_count);
      EXPECT_EQ(counts.triangles, part.triangle_count);
      EXPECT_EQ(counts.quadrics, part.quadric_count);
    }
  }
  EXPECT_LT(4 * (of_volumes.triangles + of_volumes.polygons), of_list.triangles + of_list.polygons);
  EXPECT_LT(4 * of_volumes.spheres, of_list.spheres);
  EXPECT_GT(of_volumes.nodes, 300u);
  EXPECT_GT(of_volumes.boxes, 2 * of_volumes.nodes);
  EXPECT_LE(of_volumes.boxes, 8 * of_volumes.nodes);
}

TEST(Traverser, InstancesUnderTransforms) {
  SceneDescription scene = test::make_mixed_scene(5, 1, 60);
  scene.objects.push_back({"many", {}, {}, {}});
  scene.root = 1;
  std::mt19937 random(11);
  for (int i = 0; i < 40; ++i) {
    ChildDescription child{0, {}, {}};
    child.transform.push_back(
        {TransformKind::scale, constant_curve(Vec4(Vec3(0.2, 0.3, 0.15) + 0.1 * Vec3(i % 3), 0)), {}, {}});
    child.transform.push_back({TransformKind::rotate,
                               constant_curve(Vec4(37.0 * i, 0, 0, 0)),
                               normalized(test::random_point(random, 1)),
                               {}});
    child.transform.push_back(
        {TransformKind::translate, constant_curve(Vec4(test::random_point(random, 3), 0)), {}, {}});
    scene.objects[1].children.push_back(child);
  }
  const CompiledScene compiled = compile(scene);
  compare_with_brute_force(compiled, 3, 3000);
  compare_packets_with_single_rays(compiled, 3, 2000);
}

/// Their costs are all the same: infinite.
TEST(Traverser, BoxesWhoseAreasAreTooLargeForAFloatAreArrangedToo) {
  std::string text =
      test::view_text() + "objects: {ball: [{sphere: {center: [0, 0, 0], radius: 1.0e+13}}]}\nscene:\n";
  for (int i = 0; i < 12; ++i)
    text += fmt::format(
        "  - {{use: ball, transform: [{{translate: {{0: [{}.0e+13, 0, 0], 4: [0, 0, 0]}}}}, {{scale: "
        "1.0e+10}}]}}\n",
        3 * i);
  const CompiledScene compiled = compile(test::load_yaml(text));
  FrameState state(compiled.scene);
  const Ray ray{Vec3(0, 0, 1e25), Vec3(0, 0, -1)};
  EXPECT_TRUE(closest_hit(compiled.scene, state.at(0), ray).is_hit());
}

TEST(Traverser, PacketsAreTheirRaysOnEverySimdTarget) {
  const CompiledScene compiled = compile(test::make_mixed_scene(12, 1, 300));
  test::on_every_target([&] { compare_packets_with_single_rays(compiled, 1, 500); });
}

/// A mesh of `count` triangles; triangle i has the corners that `corner(i, 0..2)` tells.
template <typename Corner>
SceneDescription make_triangles(uint32_t count, Corner corner) {
  SceneDescription scene;
  scene.files = {"triangles"};
  scene.materials.emplace_back("default");
  MeshShape mesh;
  for (uint32_t i = 0; i < count; ++i) {
    for (uint32_t k = 0; k < 3; ++k) mesh.positions.emplace_back(corner(i, k));
    mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  }
  scene.objects.push_back({"mesh", {{mesh, 0, {}}}, {}, {}});
  return scene;
}

TEST(Traverser, LongWallsAmongSmallThingsAreClippedAndFound) {
  // Slanted walls through a cloud of small triangles: the walls' boxes would hold everything.
  std::mt19937 random(21);
  std::vector<Vec3> corners;
  for (int i = 0; i < 40; ++i)
    for (int k = 0; k < 3; ++k) corners.push_back(test::random_point(random, 1));
  for (int i = 0; i < 3000; ++i) {
    const Vec3 center = test::random_point(random, 1);
    for (int k = 0; k < 3; ++k) corners.push_back(center + test::random_point(random, 0.02));
  }
  const CompiledScene compiled = compile(make_triangles(
      static_cast<uint32_t>(corners.size() / 3), [&](uint32_t i, uint32_t k) { return corners[3 * i + k]; }));
  EXPECT_EQ(compiled.scene.parts[0].triangle_count, corners.size() / 3);
  size_t pieces = 0;
  for (const TriangleBlock& block : compiled.scene.triangle_blocks)
    for (const PrimitiveId p : block.primitives) pieces += p == kNoPrimitive ? 0 : 1;
  EXPECT_GT(pieces, corners.size() / 3 + 100);
  compare_with_brute_force(compiled, 1, 3000);
  compare_packets_with_single_rays(compiled, 1, 1000);
}

TEST(Traverser, ExtremeDataStayWithinTheStack) {
  // Sizes that double from one triangle to the next make the deepest binary trees.
  const CompiledScene doubling = compile(make_triangles(200, [](uint32_t i, uint32_t k) {
    const double size = std::ldexp(1.0, static_cast<int>(i) / 4 - 25);
    return Vec3(size, k == 1 ? size : 0, k == 2 ? size : 0);
  }));
  compare_with_brute_force(doubling, 10, 3000);
  // All in one place: no split can part them.
  const CompiledScene equal = compile(make_triangles(
      1000, [](uint32_t, uint32_t k) { return Vec3(k == 0 ? -1 : 1, k == 1 ? -1 : 1, k == 2 ? 0.5 : 0); }));
  compare_with_brute_force(equal, 1, 1000);
}

TEST(Traverser, SpecksOnALineAreFound) {
  // Spheres so small that their boxes, and the whole scene's box, have no area.
  SceneDescription scene;
  scene.files = {"specks"};
  scene.materials.emplace_back("default");
  scene.objects.push_back({"specks", {}, {}, {}});
  for (int i = 0; i < 10; ++i) scene.objects[0].primitives.push_back({SphereShape{{i, 1, 1}, 1e-20}, 0, {}});
  const CompiledScene compiled = compile(scene);
  FrameState frame_pose(compiled.scene);
  const Pose pose = frame_pose.at(0);
  for (int i = 0; i < 10; ++i) {
    const Ray ray{{i - 0.5, 1, 1}, {1, 0, 0}};
    const Hit hit = closest_hit(compiled.scene, pose, ray);
    EXPECT_TRUE(hit.is_hit()) << i;
    expect_same(hit, closest_hit_brute_force(compiled.scene, pose, ray));
  }
}

TEST(Traverser, AMeshTakesAtMost64BytesPerTriangle) {
  constexpr uint32_t kSide = 100;
  const CompiledScene compiled = compile(make_triangles(2 * kSide * kSide, [](uint32_t i, uint32_t k) {
    const uint32_t cell = i / 2, x = cell % kSide, z = cell / kSide;
    const bool is_second = i % 2 != 0;
    const double u = x + ((k == 1) != is_second ? 1.0 : 0.0), v = z + ((k == 2) != is_second ? 1.0 : 0.0);
    return Vec3(u, std::sin(0.3 * u) * std::cos(0.2 * v), v);
  }));
  const Scene& scene = compiled.scene;
  EXPECT_LE(static_cast<double>(scene.nodes.size_bytes() + scene.triangle_blocks.size_bytes()),
            64.0 * scene.parts[0].triangle_count);
}

TEST(Traverser, WhatNeverMovesIsOnePart) {
  const CompiledScene compiled =
      compile(test::load_yaml(test::view_text() + "objects:\n"
                                                  "  shared: {sphere: {center: [0, 0, 0], radius: 1}}\n"
                                                  "scene:\n"
                                                  "  - {sphere: {center: [5, 0, 0], radius: 1}}\n"
                                                  "  - group: [{sphere: {center: [9, 0, 0], radius: 1}}]\n"
                                                  "  - {use: shared}\n"
                                                  "  - {use: shared, transform: {translate: [0, 5, 0]}}\n"
                                                  "  - {transform: {translate: [0, 9, 0]}, sphere: {center: "
                                                  "[0, 0, 0], radius: 1}}\n"));
  EXPECT_EQ(compiled.scene.instances.size(),
            4u);  // the fixed two, the shared one twice, the one that was moved
  EXPECT_EQ(compiled.scene.parts.size(), 3u);
}

TEST(Traverser, EverySimdTargetGivesTheSameBits) {
  const CompiledScene compiled = compile(test::make_mixed_scene(6, 1, 500));
  FrameState frame_pose(compiled.scene);
  const Pose pose = frame_pose.at(0);
  const std::vector<std::string> targets = simd_targets();
  ASSERT_FALSE(targets.empty());
  std::vector<std::vector<Hit>> hits;
  for (const std::string& target : targets) {
    force_simd_target(target);
    std::mt19937 random(9);
    hits.emplace_back();
    for (int i = 0; i < 5000; ++i)
      hits.back().push_back(closest_hit(compiled.scene, pose, random_ray(random, 1)));
  }
  force_simd_target("");
  for (size_t target = 1; target < hits.size(); ++target)
    for (size_t i = 0; i < hits[0].size(); ++i) {
      expect_same(hits[target][i], hits[0][i]);
      EXPECT_EQ(hits[target][i].u, hits[0][i].u);
    }
}

TEST(Traverser, NoRayLeaksThroughTheEdgesOfAClosedMesh) {
  // A bumpy sphere of latitudes and longitudes; from inside, every ray must hit, also those aimed at vertices
  // and at the middles of edges.
  constexpr int kRows = 24, kColumns = 48;
  SceneDescription scene;
  scene.files = {"closed"};
  scene.materials.emplace_back("default");
  scene.objects.push_back({"mesh", {}, {}, {}});
  MeshShape mesh;
  for (int i = 0; i <= kRows; ++i)
    for (int j = 0; j < kColumns; ++j) {
      const double theta = M_PI * i / kRows, phi = 2 * M_PI * j / kColumns;
      const double r = 1 + 0.1 * std::sin(5 * phi) * std::sin(3 * theta) * std::sin(theta);
      mesh.positions.emplace_back(
          i == 0 || i == kRows
              ? Vec3(0, i == 0 ? 1 : -1, 0)
              : r * Vec3(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)));
    }
  for (int i = 0; i < kRows; ++i)
    for (int j = 0; j < kColumns; ++j) {
      const auto at = [&](int row, int column) {
        return static_cast<uint32_t>(row * kColumns + column % kColumns);
      };
      mesh.triangles.emplace_back(at(i, j), at(i + 1, j), at(i, j + 1));
      mesh.triangles.emplace_back(at(i, j + 1), at(i + 1, j), at(i + 1, j + 1));
    }
  const LargeVector<glm::vec3> positions = mesh.positions;
  const LargeVector<glm::uvec3> triangles = mesh.triangles;
  scene.objects[0].primitives.push_back({mesh, 0, {}});
  const CompiledScene compiled = compile(scene);
  ASSERT_EQ(compiled.notes.lines().size(), 1u);
  EXPECT_NE(compiled.notes.lines()[0].find(fmt::format("{} polygons or triangles", 2 * kColumns)),
            std::string::npos);
  FrameState frame_pose(compiled.scene);
  const Pose pose = frame_pose.at(0);
  std::mt19937 random(2);
  for (const glm::uvec3& t : triangles)
    for (int k = 0; k < 3; ++k) {
      const Vec3 a(positions[t[k]]), b(positions[t[(k + 1) % 3]]);
      const Vec3 origin = test::random_point(random, 0.2);
      for (const Vec3& target : {a, 0.5 * (a + b), a + 0.3 * (b - a)})
        EXPECT_TRUE(closest_hit(compiled.scene, pose, {origin, normalized(target - origin)}).is_hit());
    }
}

TEST(Traverser, EmptySceneHitsNothing) {
  const CompiledScene compiled = compile(test::load_yaml(test::view_text() + "scene: []\n"));
  FrameState frame_pose(compiled.scene);
  EXPECT_FALSE(closest_hit(compiled.scene, frame_pose.at(0), {Vec3(0), Vec3(0, 0, 1)}).is_hit());
}

}  // namespace
}  // namespace rayfarm
