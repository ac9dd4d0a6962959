// What threads remember of rays for those that follow: the last hit, and lists of what rays from a primitive
// can meet. Answers are those without.
#include "common/hierarchy/ray_memory.h"

#include <set>
#include <thread>

#include "common/hierarchy/traverser.h"
#include "common/hierarchy/walk_counts.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

struct Switches {
  bool has_last_hit;
  double ray_coherence;
};
constexpr std::array<Switches, 4> kAllSwitches{{{true, 0}, {false, 8}, {false, 50}, {true, 20}}};

BuildOptions with(Hierarchy hierarchy, const Switches& switches) {
  BuildOptions options;
  options.hierarchy = hierarchy;
  options.max_primitives = 4;
  options.has_last_hit = switches.has_last_hit;
  options.ray_coherence = switches.ray_coherence;
  return options;
}

/// A way of a ray through a scene: it goes on from what it hits, or begins anew.
class Wanderer {
 public:
  Wanderer(const Pose& pose, double size, uint32_t seed) : pose_(pose), size_(size), random_(seed) {}
  Ray next() {
    Vec3 d = normalized(test::random_point(random_, 1));
    if (random_() % 3 == 0) d[static_cast<int>(random_() % 3)] = 0;
    Ray ray{origin_, d * test::uniform(random_, 0.1, 3)};
    if (random_() % 4 == 0) ray.t_max = test::uniform(random_, 0, size_);
    return ray;
  }
  void go(const Ray& ray, const Hit& hit) {
    origin_ = hit.is_hit() && random_() % 8 != 0 ? ray.origin + hit.t * (1 - 1e-9) * ray.direction
                                                 : test::random_point(random_, 1.5 * size_);
  }

 private:
  const Pose& pose_;
  double size_;
  std::mt19937 random_;
  Vec3 origin_{0};
};

void expect_same_hit(const Hit& a, const Hit& b) {
  ASSERT_EQ(a.is_hit(), b.is_hit());
  if (!a.is_hit()) return;
  ASSERT_EQ(a.t, b.t);
  ASSERT_EQ(a.instance, b.instance);
  ASSERT_EQ(a.primitive, b.primitive);
  ASSERT_EQ(a.u, b.u);
  ASSERT_EQ(a.v, b.v);
  ASSERT_EQ(a.w, b.w);
}

/// Every answer about `with_switches` is that about `plain`, single and in packets.
void compare(const CompiledScene& with_switches, const CompiledScene& plain, double frame, double size,
             int ways) {
  FrameState state(with_switches.scene), plain_state(plain.scene);
  const Pose pose = state.at(frame), plain_pose = plain_state.at(frame);
  Wanderer wanderer(pose, size, 7);
  int hits = 0;
  for (int i = 0; i < ways; ++i) {
    const Ray ray = wanderer.next();
    const Hit expected = closest_hit(plain.scene, plain_pose, ray);
    expect_same_hit(closest_hit(with_switches.scene, pose, ray), expected);
    ASSERT_EQ(any_hit(with_switches.scene, pose, ray), any_hit(plain.scene, plain_pose, ray));
    hits += expected.is_hit();
    if (i % 4 == 0) {  // neighbours of the ray, from where the last ones arrived
      std::vector<Ray> rays;
      for (int k = 0; k < 1 + i / 4 % 8; ++k)
        rays.push_back({ray.origin, ray.direction + Vec3(0.01 * k, 0.02 * k, 0.01), ray.t_max});
      std::array<Hit, kMostPacketRays> packet, plain_packet;
      closest_hits(with_switches.scene, pose, RayPacket(rays), packet.data());
      closest_hits(plain.scene, plain_pose, RayPacket(rays), plain_packet.data());
      for (size_t k = 0; k < rays.size(); ++k) expect_same_hit(packet[k], plain_packet[k]);
      const uint32_t among = 0x5bu & RayPacket(rays).all();
      ASSERT_EQ(any_hits(with_switches.scene, pose, RayPacket(rays), among),
                any_hits(plain.scene, plain_pose, RayPacket(rays), among));
    }
    wanderer.go(ray, expected);
  }
  if (ways >= 100) {
    EXPECT_GT(8 * hits, ways);
  }
}

class RayMemories : public testing::TestWithParam<Hierarchy> {};

// Shirley, Sung and Brown, 2.3.2: "extract the candidate primitives associated with the corresponding
// direction/angle pair for potential intersection calculations".
TEST_P(RayMemories, AnswersAreThoseWithout) {
  const SceneDescription mixed = test::make_mixed_scene(4, 1, 100);
  const CompiledScene plain = compile(mixed, with(GetParam(), {false, 0}));
  for (const Switches& switches : kAllSwitches)
    compare(compile(mixed, with(GetParam(), switches)), plain, 0, 1, 300);
}

TEST_P(RayMemories, OfMovingObjectsToo) {
  std::string text = test::view_text() +
                     "objects:\n  pair:\n    - {sphere: {center: [0, 0, 0], radius: 0.4}}\n" +
                     "    - {polygon: {points: [[0, 0, 0], [1, 0, 0], [1, 1, 0.5]]}}\nscene:\n" +
                     "  - {polygon: {points: [[-3, -1, -3], [3, -1, -3], [3, -1, 3], [-3, -1, 3]]}}\n";
  for (int i = 0; i < 6; ++i)
    text += fmt::format("  - {{use: pair, transform: [{{scale: [1, 0.5, 2]}}, {{translate: {}}}]{}}}\n",
                        i % 2 == 0 ? fmt::format("[{}, 0, 1]", i - 3)
                                   : fmt::format("{{0: [{0}, 0, 0], 4: [{0}, 1, 1]}}", i - 3),
                        i == 5 ? ", visible: {0: true, 3: false}" : "");
  const SceneDescription moving = test::load_yaml(text);
  const CompiledScene plain = compile(moving, with(GetParam(), {false, 0}));
  for (const Switches& switches : kAllSwitches) {
    const CompiledScene compiled = compile(moving, with(GetParam(), switches));
    for (const double frame : {0.0, 4.0, 2.5}) compare(compiled, plain, frame, 3, 150);
  }
}

INSTANTIATE_TEST_SUITE_P(, RayMemories,
                         testing::Values(Hierarchy::sah, Hierarchy::thesis, Hierarchy::regular,
                                         Hierarchy::adaptive, Hierarchy::brute, Hierarchy::object));

/// Two quadrilaterals in one place: which is hit is decided by their numbers, whatever was tested before.
// Whose hits are moved onto the surface when they have been found.
TEST(RayMemory, WiresAreHitAsWithout) {
  const SceneDescription wire =
      test::load_yaml(test::view_text() +
                      "scene:\n  - {cylinder: {base: [0, 0, 0], top: [3, 10, 1], radius: 0.01}}\n"
                      "  - {cylinder: {base: [0, 0, 0.2], top: [-3, 10, 1], radius: 0.01}}\n");
  for (const Hierarchy hierarchy : {Hierarchy::sah, Hierarchy::brute, Hierarchy::regular}) {
    const CompiledScene plain = compile(wire, with(hierarchy, {false, 0})),
                        remembering = compile(wire, with(hierarchy, {true, 20}));
    FrameState plain_state(plain.scene), state(remembering.scene);
    std::mt19937 random(3);
    int hits = 0;
    for (int i = 0; i < 4000; ++i) {
      const Vec3 eye(0.05, 0.12, 0.4), target = test::uniform(random, 0, 1) * Vec3(3, 10, 1);
      const Ray ray{eye, target + test::random_point(random, 0.01) - eye};
      const Hit expected = closest_hit(plain.scene, plain_state.at(0), ray);
      expect_same_hit(closest_hit(remembering.scene, state.at(0), ray), expected);
      hits += expected.is_hit();
    }
    EXPECT_GT(hits, 500);
  }
}

TEST(RayMemory, TiesAreDecidedAsWithout) {
  const std::string twice =
      "  - {polygon: {points: [[-1, -1, 0], [2, -1, 0], [2, 1, 0], [-1, 1, 0]]}}\n"
      "  - {polygon: {points: [[-2, -1, 0], [1, -1, 0], [1, 1, 0], [-2, 1, 0]]}}\n";
  const SceneDescription scene = test::load_yaml(test::view_text() + "scene:\n" + twice);
  const CompiledScene compiled = compile(scene, with(Hierarchy::sah, {true, 0})),
                      plain = compile(scene, with(Hierarchy::sah, {false, 0}));
  FrameState state(compiled.scene), plain_state(plain.scene);
  std::set<uint32_t> of_both, of_one;
  for (const double x : {1.5, 0.5, -1.5, 0.5, 1.5, -0.5, -1.5, -0.5}) {  // one alone, and then both
    const Ray ray{Vec3(x, 0.1, 3), Vec3(0, 0, -1)};
    const Hit expected = closest_hit(plain.scene, plain_state.at(0), ray);
    (std::abs(x) < 1 ? of_both : of_one).insert(expected.primitive.bits);
    expect_same_hit(closest_hit(compiled.scene, state.at(0), ray), expected);
  }
  EXPECT_EQ(of_one.size(), 2u);
  EXPECT_EQ(of_both.size(), 1u);
}

/// Ten balls in a row, and a camera that looks along a floor.
CompiledScene compile_row(const BuildOptions& options) {
  std::string text = test::view_text() + "scene:\n";
  for (int i = 0; i < 10; ++i)
    text += fmt::format("  - {{sphere: {{center: [{}, 0, 0], radius: 0.4}}}}\n", 3 * i);
  return compile(test::load_yaml(text), options);
}

TEST(RayMemory, WhatTheLastRayHitIsTestedFirst) {
  const CompiledScene row = compile_row(with(Hierarchy::brute, {true, 0}));
  FrameState state(row.scene);
  WalkCounts counts;
  const auto trace = [&](double x) {
    closest_hit_counted(row.scene, state.at(0), {Vec3(x, 0, 5), Vec3(0, 0, -1)}, counts);
    return std::pair(counts.last_hit_tests, counts.last_hits);
  };
  using Pair = std::pair<uint64_t, uint64_t>;
  EXPECT_EQ(trace(0), Pair(0, 0));    // nothing was hit before
  EXPECT_EQ(trace(0.1), Pair(1, 1));  // the same ball
  EXPECT_EQ(trace(3), Pair(2, 1));    // another
  EXPECT_EQ(trace(4.5), Pair(3, 1));  // none: the last hit stays
  EXPECT_EQ(trace(3.1), Pair(4, 2));
  EXPECT_EQ(counts.spheres, 5u * 10 + 4);
  // A shadow ray is over where the occluder stops it.
  WalkCounts of_shadows;
  const auto is_shadowed = [&](double x) {
    const bool is_hit = any_hit_counted(row.scene, state.at(0), {Vec3(x, 0, 5), Vec3(0, 0, -1)}, of_shadows);
    return std::pair(is_hit, of_shadows.spheres);
  };
  EXPECT_EQ(is_shadowed(3.1), std::pair(true, uint64_t{10}));  // the other kind of rays has its own memory
  EXPECT_EQ(is_shadowed(3), std::pair(true, uint64_t{11}));
  EXPECT_EQ(is_shadowed(4.5), std::pair(false, uint64_t{22}));
  EXPECT_EQ(of_shadows.last_hit_tests, 2u);
  EXPECT_EQ(of_shadows.last_hits, 1u);
}

// "A direction and an acute angle as the geometric characteristic": from a ball in a row along the row
// itself, or across it.
TEST(RayMemory, CandidatesAreThoseInTheCone) {
  const CompiledScene row = compile_row(with(Hierarchy::brute, {false, 5}));
  FrameState state(row.scene);
  WalkCounts counts;
  const auto trace = [&](const Vec3& origin, const Vec3& direction, double t_max) {
    counts = {};
    return closest_hit_counted(row.scene, state.at(0), {origin, direction, t_max}, counts);
  };
  // A ray along `direction` from where another one arrives, which comes from there.
  const auto trace_from = [&](const Vec3& point, const Vec3& outward, const Vec3& direction) {
    trace(point + outward, -outward, 9);
    EXPECT_EQ(counts.coherent_rays, 0u);  // it begins at nothing
    return trace(point + 1e-10 * outward, direction, 90);
  };
  EXPECT_NEAR(trace_from({0.4, 0, 0}, {1, 0, 0}, {1, 0, 0}).t, 2.2, 1e-9);
  EXPECT_EQ(counts.coherent_rays, 1u);
  EXPECT_EQ(counts.lists, 1u);
  EXPECT_EQ(counts.candidates, 2u);  // itself and its neighbour; the others lie behind the hit
  EXPECT_NEAR(trace({2.6 - 1e-10, 0, 0}, {-1, 0, 0}, 90).t, 2.2, 1e-9);  // from where that one arrived
  EXPECT_EQ(counts.coherent_rays, 1u);
  EXPECT_EQ(counts.candidates, 2u);
  EXPECT_FALSE(trace_from({0, 0.4, 0}, {0, 1, 0}, {0, 1, 0}).is_hit());
  EXPECT_EQ(counts.lists, 1u);  // of other directions
  EXPECT_EQ(counts.candidates, 1u);
  EXPECT_FALSE(trace_from({0.24, 0.32, 0}, {0.6, 0.8, 0}, {0.01, 1, 0.01}).is_hit());
  EXPECT_EQ(counts.coherent_rays, 1u);
  EXPECT_EQ(counts.lists, 0u);                                         // it is there
  EXPECT_EQ(trace({1.5, 0, 0}, {1, 0, 0}, 90).primitive.index(), 1u);  // from between balls
  EXPECT_EQ(counts.coherent_rays, 0u);
  EXPECT_EQ(counts.spheres, 10u);
}

/// The ball about a floor holds all that stands on it: it is searched as usual.
TEST(RayMemory, OfWhatCanMeetMuchThereIsNoList) {
  for (const size_t balls : {kMostInList - 1, kMostInList + 1}) {
    std::string text = test::view_text() + "scene:\n  - {sphere: {center: [0, 0, 0], radius: 100}}\n";
    for (size_t i = 0; i + 1 < balls; ++i)
      text += fmt::format("  - {{sphere: {{center: [{}, {}, 1], radius: 0.4}}}}\n", i % 9, i / 9);
    const CompiledScene compiled = compile(test::load_yaml(text), with(Hierarchy::sah, {false, 5}));
    FrameState state(compiled.scene);
    WalkCounts counts;
    const Hit hit = closest_hit_counted(compiled.scene, state.at(0), {Vec3(0), Vec3(0, 0, -1)}, counts);
    ASSERT_EQ(hit.t, 100);
    EXPECT_TRUE(
        closest_hit_counted(compiled.scene, state.at(0), {Vec3(0, 0, -99.9999999), Vec3(0, 0, 1)}, counts)
            .is_hit());
    EXPECT_EQ(counts.lists, 1u);
    EXPECT_EQ(counts.coherent_rays, balls <= kMostInList ? 1u : 0u);
  }
}

/// Parts of many primitives are candidates as wholes.
TEST(RayMemory, MeshesAreOneCandidate) {
  const SceneDescription many = test::make_mixed_scene(3, 1, kMostPrimitivesApart + 400);
  const CompiledScene plain = compile(many), compiled = compile(many, with(Hierarchy::sah, {false, 30}));
  EXPECT_EQ(candidates_of(compiled.scene).size(), 1u);
  compare(compiled, plain, 0, 1, 100);
  EXPECT_TRUE(candidates_of(compile(many, with(Hierarchy::object, {false, 30})).scene).empty());
  ASSERT_FALSE(compiled.notes.lines().empty());
  EXPECT_NE(compiled.notes.lines().back().find("--ray-coherence"), std::string::npos);
}

TEST(RayMemory, ThreadsShareNothingAndScenesAreToldApart) {
  const SceneDescription mixed = test::make_mixed_scene(4, 1, 60), few = test::make_mixed_scene(5, 1, 7);
  const CompiledScene plain = compile(mixed), compiled = compile(mixed, with(Hierarchy::sah, {true, 20})),
                      plain_few = compile(few), other = compile(few, with(Hierarchy::sah, {true, 20}));
  std::vector<std::jthread> threads;
  for (int t = 0; t < 3; ++t)
    threads.emplace_back([&] {
      for (int i = 0; i < 3; ++i) {  // what is remembered of one scene is not in the other
        compare(compiled, plain, 0, 1, 40);
        compare(other, plain_few, 0, 1, 5);
      }
    });
}

TEST(RayMemory, DamagedSwitchesAreRefused) {
  const CompiledScene row = compile_row({});
  const auto is_refused = [&](uint32_t has_last_hit, double ray_coherence) {
    Scene scene = row.scene;
    SceneHeader header = scene.head();
    header.has_last_hit = has_last_hit;
    header.ray_coherence = ray_coherence;
    scene.header = {&header, 1};
    try {
      decode_scene(encode_scene(scene).bytes());
    } catch (const SceneBlockError&) {
      return true;
    }
    return false;
  };
  EXPECT_FALSE(is_refused(1, 1));
  EXPECT_TRUE(is_refused(2, 0));
  EXPECT_TRUE(is_refused(0, -0.1));
  EXPECT_TRUE(is_refused(0, 1.6));
  EXPECT_TRUE(is_refused(0, 1e-9));  // more cells than can be counted
  EXPECT_TRUE(is_refused(0, NAN));
}

}  // namespace
}  // namespace rayfarm
