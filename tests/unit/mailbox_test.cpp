// The mailbox of cells: which tests it saves, and that no hit shows it.
#include "common/hierarchy/mailbox.h"

#include <thread>

#include "common/hierarchy/traverser.h"
#include "common/hierarchy/walk_counts.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

/// Beams through many cells, and some quadrics and balls.
SceneDescription make_beams() {
  SceneDescription scene = test::make_mixed_scene(3, 1, 40);
  std::mt19937 random(2);
  for (int i = 0; i < 30; ++i)
    scene.objects[0].primitives.push_back(
        {PolygonShape{
             {test::random_point(random, 2), test::random_point(random, 2), test::random_point(random, 2)},
             {},
             Smoothing::flat},
         0,
         {}});
  return scene;
}

CompiledScene compile_beams(Hierarchy hierarchy, bool has_mailbox) {
  return compile(
      make_beams(),
      {.hierarchy = hierarchy, .max_primitives = 4, .octree_depth = 5, .has_mailbox = has_mailbox});
}

std::vector<Ray> make_rays(int count) {
  std::mt19937 random(8);
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i)
    rays.push_back({test::random_point(random, 2), normalized(test::random_point(random, 1))});
  return rays;
}

// Shirley, Sung and Brown, 2.3.3: "avoid multiple ray-object intersection calculation between the same object
// and the same ray in different spatial cell units".
TEST(Mailbox, TestsAPrimitiveOnceForARayAndCountsTheTestsItSaves) {
  for (const Hierarchy hierarchy : {Hierarchy::regular, Hierarchy::adaptive}) {
    const CompiledScene without = compile_beams(hierarchy, false), with = compile_beams(hierarchy, true);
    FrameState state_without(without.scene), state_with(with.scene);
    WalkCounts all, once;
    for (const Ray& ray : make_rays(300)) {
      WalkCounts of_ray;
      const Hit a = closest_hit_counted(without.scene, state_without.at(0), ray, all),
                b = closest_hit_counted(with.scene, state_with.at(0), ray, of_ray);
      EXPECT_EQ(a.t, b.t);
      EXPECT_EQ(a.primitive, b.primitive);
      EXPECT_LE(of_ray.primitives(), 70u);  // as many as there are
      once.saved_tests += of_ray.saved_tests;
      once.spheres += of_ray.primitives();
      once.cells += of_ray.cells;
    }
    EXPECT_EQ(all.saved_tests, 0u);
    EXPECT_GT(once.saved_tests, all.primitives() / 4);
    EXPECT_EQ(once.primitives() + once.saved_tests, all.primitives());
    EXPECT_EQ(once.cells, all.cells);
  }
}

/// "Its utility may be highly dependent on the general spatial character of the geometric primitives".
TEST(Mailbox, SavesNothingWhereNothingIsInTwoCells) {
  std::string balls;
  for (int i = 0; i < 5; ++i)
    balls += fmt::format("  - {{sphere: {{center: [{}, 0.5, 0.5], radius: 0.4}}}}\n", i + 0.5);
  balls += "  - {sphere: {center: [0.2, 0.01, 0.01], radius: 0.01}}\n";
  balls += "  - {sphere: {center: [4.99, 0.99, 0.99], radius: 0.01}}\n";
  const CompiledScene compiled = compile(test::load_yaml(test::view_text() + "scene:\n" + balls),
                                         {.hierarchy = Hierarchy::regular, .cells = 5, .has_mailbox = true});
  FrameState state(compiled.scene);
  WalkCounts counts;
  // Above all balls, through cells that list one each.
  closest_hit_counted(compiled.scene, state.at(0), {Vec3(-1, 0.95, 0.5), Vec3(1, 0, 0)}, counts);
  EXPECT_EQ(counts.cells, 5u);
  EXPECT_EQ(counts.primitives(), 5u);
  EXPECT_EQ(counts.saved_tests, 0u);
}

TEST(Mailbox, ThreadsAndScenesDoNotReadEachOthers) {
  const CompiledScene a = compile_beams(Hierarchy::regular, true),
                      b = compile(
                          test::make_mixed_scene(5, 1, 60),
                          {.hierarchy = Hierarchy::adaptive, .max_primitives = 2, .has_mailbox = true});
  const std::vector<Ray> rays = make_rays(300);
  std::array<int, 3> differences{};
  {
    std::vector<std::jthread> threads;
    for (int& different : differences)
      threads.emplace_back([&] {
        FrameState state_a(a.scene), state_b(b.scene);
        for (const Ray& ray : rays) {  // by turns, in the same memory
          different += closest_hit(a.scene, state_a.at(0), ray).t !=
                       closest_hit_brute_force(a.scene, state_a.at(0), ray).t;
          different += closest_hit(b.scene, state_b.at(0), ray).t !=
                       closest_hit_brute_force(b.scene, state_b.at(0), ray).t;
          different += any_hit(b.scene, state_b.at(0), ray) !=
                       closest_hit_brute_force(b.scene, state_b.at(0), ray).is_hit();
        }
      });
  }
  EXPECT_EQ(differences, (std::array{0, 0, 0}));
}

// It is as large as what a collection holds, not as the scene, and no collection reads what another noted.
TEST(Mailbox, NumbersACollectionsOwnPrimitives) {
  Mailbox& mailbox = Mailbox::of_this_thread();
  Collection small;
  small.first_triangle_block = small.first_sphere_block = 1u << 26;
  small.triangle_block_count = small.sphere_block_count = 1;
  small.first_leaf_primitive = 1u << 29;
  small.leaf_primitive_count = 2;
  const Mailbox::Search search = mailbox.begin_search(small);
  const std::array pointers{
      make_pointer(PointerKind::triangle, 8u << 26), make_pointer(PointerKind::triangle, (8u << 26) + 7),
      make_pointer(PointerKind::sphere, 8u << 26), make_pointer(PointerKind::other, (1u << 29) + 1)};
  for (const PrimitivePointer& p : pointers) {
    EXPECT_TRUE(mailbox.take(p, search));
    EXPECT_FALSE(mailbox.take(p, search));
  }
  const Mailbox::Search next = mailbox.begin_search(small);
  for (const PrimitivePointer& p : pointers) EXPECT_TRUE(mailbox.take(p, next));
}

/// An instance is another ray.
TEST(Mailbox, InstancesOfAPartAreTestedEach) {
  std::string text = test::view_text() + "objects:\n  pile:\n";
  std::mt19937 random(4);
  for (int i = 0; i < 20; ++i) {
    const Vec3 c = test::random_point(random, 1);
    text += fmt::format("    - {{sphere: {{center: [{}, {}, {}], radius: 0.3}}}}\n", c.x, c.y, c.z);
  }
  text += "scene:\n  - {use: pile}\n  - {use: pile, transform: {translate: [0.5, 0.1, 0]}}\n";
  for (const Hierarchy hierarchy : {Hierarchy::regular, Hierarchy::adaptive}) {
    const CompiledScene compiled =
        compile(test::load_yaml(text), {.hierarchy = hierarchy, .max_primitives = 2, .has_mailbox = true});
    ASSERT_EQ(compiled.scene.instances.size(), 2u);
    FrameState state(compiled.scene);
    for (const Ray& ray : make_rays(500)) {
      const Hit fast = closest_hit(compiled.scene, state.at(0), ray),
                slow = closest_hit_brute_force(compiled.scene, state.at(0), ray);
      ASSERT_EQ(fast.t, slow.t);
      ASSERT_EQ(fast.instance, slow.instance);
    }
  }
}

}  // namespace
}  // namespace rayfarm
