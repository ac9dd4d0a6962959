// Octrees that are built while rays are traced: the cells of those that are built before, and fewer.
#include "common/hierarchy/growing_octree.h"

#include <map>
#include <thread>

#include "common/hierarchy/octree.h"
#include "common/hierarchy/storage.h"
#include "common/hierarchy/traverser.h"
#include "common/hierarchy/walk_counts.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

BuildOptions adaptive(OctreeBuild build, uint32_t max_primitives = 4) {
  BuildOptions options;
  options.hierarchy = Hierarchy::adaptive;
  options.max_primitives = max_primitives;
  options.octree_build = build;
  return options;
}

/// By the names of cells the primitives that they list.
using Cells = std::map<uint64_t, std::vector<uint32_t>>;

std::vector<uint32_t> bits_of(std::span<const PrimitivePointer> pointers) {
  std::vector<uint32_t> bits;
  for (const PrimitivePointer& p : pointers) bits.push_back(p.bits);
  return bits;
}

Cells cells_built_before(const Scene& scene) {
  Cells cells;
  for (const OctreeCell& cell : scene.octree_cells)
    cells[cell.name] = bits_of(scene.primitive_pointers.subspan(cell.first_pointer, cell.pointer_count));
  return cells;
}

/// Enters every node.
void grow_all(const Scene& scene, GrownOctree& grown, GrownNode& node, Cells& cells) {
  enter_open_node(scene, scene.octrees[0], grown, node);
  for (GrownNode* child = node.child; child; child = child->sibling) grow_all(scene, grown, *child, cells);
  if (node.state == GrownNode::State::cell) cells[node.name] = bits_of(node.primitives);
}

// Shirley, Sung and Brown, 2.3.2: "the builder can build the octree structure statically before ray tracing
// starts, or dynamically during ray tracing".
TEST(GrowingOctree, HasTheCellsAndNamesOfOneThatIsBuiltBefore) {
  const SceneDescription mixed = test::make_mixed_scene(9, 1, 150);
  const CompiledScene before = compile(mixed, adaptive(OctreeBuild::before)),
                      tracing = compile(mixed, adaptive(OctreeBuild::tracing));
  ASSERT_EQ(tracing.scene.octree_cells.size(), 1u);
  GrownOctree& grown = *tracing.scene.tracing->octrees[0];
  Cells cells;
  grow_all(tracing.scene, grown, *grown.root, cells);
  EXPECT_GT(cells.size(), 100u);
  EXPECT_EQ(cells, cells_built_before(before.scene));
  EXPECT_EQ(storage_of(tracing.scene, 0).nodes, storage_of(before.scene, 0).nodes);
  EXPECT_EQ(storage_of(tracing.scene, 0).pointers, storage_of(before.scene, 0).pointers);
  EXPECT_EQ(storage_of(tracing.scene, 0).bytes(), storage_of(before.scene, 0).bytes());
}

TEST(GrowingOctree, NodesAreDividedWhenARayFirstComesIntoThem) {
  const CompiledScene three = compile(test::load_yaml(test::view_text() + R"(scene:
  - {sphere: {center: [0.45, 0.45, 0.45], radius: 0.45}}
  - {sphere: {center: [1.5, 0.45, 0.45], radius: 0.4}}
  - {sphere: {center: [3.5, 3.5, 3.5], radius: 0.5}}
)"),
                                      adaptive(OctreeBuild::tracing, 1));
  FrameState state(three.scene);
  const auto nodes_after = [&](const Vec3& origin, const Vec3& direction) {
    closest_hit(three.scene, state.at(0), {origin, direction});
    return storage_of(three.scene, 0).nodes;
  };
  EXPECT_EQ(storage_of(three.scene, 0).nodes, 1u);
  EXPECT_EQ(nodes_after({-1, 9, 0}, {1, 0, 0}), 1u);        // past the whole
  EXPECT_EQ(nodes_after({-1, 3.5, 3.5}, {1, 0, 0}), 3u);    // two octants hold something
  EXPECT_EQ(nodes_after({-1, 3.5, 0.5}, {1, 0, 0}), 3u);    // one that holds nothing
  EXPECT_EQ(nodes_after({-1, 0.5, 0.5}, {1, 0, 0}), 5u);    // as many as one that is built before has
  EXPECT_EQ(nodes_after({5, 0.5, 0.5}, {-1, 0, 0.1}), 5u);  // once
}

TEST(GrowingOctree, ARayVisitsTheCellsOfOneThatIsBuiltBefore) {
  const SceneDescription mixed = test::make_mixed_scene(9, 1, 80);
  for (const OctreeData data : {OctreeData::hash, OctreeData::pointers})
    for (const OctreeNext next : {OctreeNext::root, OctreeNext::walk, OctreeNext::dda})
      for (const bool has_mailbox : {false, true}) {
        const auto build = [&](OctreeBuild when) {
          BuildOptions options = adaptive(when, 2);
          options.octree_data = data;
          options.octree_next = next;
          options.has_mailbox = has_mailbox;
          return compile(mixed, options);
        };
        const CompiledScene before = build(OctreeBuild::before), tracing = build(OctreeBuild::tracing);
        FrameState state(before.scene), state_of_tracing(tracing.scene);
        std::mt19937 random(5);
        for (int i = 0; i < 100; ++i) {
          const Ray ray{test::random_point(random, 2), normalized(test::random_point(random, 1))};
          WalkCounts expected, counts;
          const Hit hit = closest_hit_counted(before.scene, state.at(0), ray, expected),
                    same = closest_hit_counted(tracing.scene, state_of_tracing.at(0), ray, counts);
          ASSERT_EQ(same.t, hit.t);
          ASSERT_EQ(same.primitive, hit.primitive);
          ASSERT_EQ(counts.cells, expected.cells);
          ASSERT_EQ(counts.empty_cells, expected.empty_cells);
          ASSERT_EQ(counts.tree_nodes, expected.tree_nodes);
          ASSERT_EQ(counts.primitives(), expected.primitives());
          ASSERT_EQ(counts.saved_tests, expected.saved_tests);
          ASSERT_EQ(any_hit(tracing.scene, state_of_tracing.at(0), ray), hit.is_hit());
        }
        EXPECT_LE(storage_of(tracing.scene, 0).nodes, storage_of(before.scene, 0).nodes);
      }
}

TEST(GrowingOctree, FewRaysMakeFewNodes) {
  const SceneDescription mixed = test::make_mixed_scene(4, 1, 1000);
  const CompiledScene before = compile(mixed, adaptive(OctreeBuild::before)),
                      tracing = compile(mixed, adaptive(OctreeBuild::tracing));
  FrameState state(tracing.scene);
  for (int i = 0; i < 10; ++i)
    closest_hit(tracing.scene, state.at(0), {Vec3(0.01 * i, 0.3, 3), Vec3(0, 0, -1)});
  EXPECT_GT(storage_of(tracing.scene, 0).nodes, 20u);
  EXPECT_LT(5 * storage_of(tracing.scene, 0).nodes, storage_of(before.scene, 0).nodes);
}

TEST(GrowingOctree, ThreadsMayBuildOneTogether) {
  const CompiledScene compiled =
      compile(test::make_mixed_scene(7, 1, 300), adaptive(OctreeBuild::tracing, 6));
  std::atomic<int> differing = 0;
  {
    std::vector<std::jthread> threads;
    for (uint32_t t = 0; t < 4; ++t)
      threads.emplace_back([&, t] {
        const Scene scene = compiled.scene;  // a copy, of the same octree
        FrameState state(scene);
        std::mt19937 random(t / 2);  // two and two ask for the same cells at the same time
        for (int i = 0; i < 300; ++i) {
          const Ray ray{test::random_point(random, 2), normalized(test::random_point(random, 1))};
          const Hit slow = closest_hit_brute_force(scene, state.at(0), ray),
                    fast = closest_hit(scene, state.at(0), ray);
          differing += fast.t != slow.t || !(fast.primitive == slow.primitive);
        }
      });
  }
  EXPECT_EQ(differing, 0);
  GrownOctree& grown = *compiled.scene.tracing->octrees[0];
  Cells cells;
  grow_all(compiled.scene, grown, *grown.root, cells);
  EXPECT_EQ(cells, cells_built_before(
                       compile(test::make_mixed_scene(7, 1, 300), adaptive(OctreeBuild::before, 6)).scene));
}

/// No division parts them: it ends where lists have become long.
TEST(GrowingOctree, PrimitivesWithEqualCentresEndTheDivision) {
  std::string balls;
  for (int i = 0; i < 20; ++i)
    balls += fmt::format("  - {{sphere: {{center: [0, 0, 0], radius: {}}}}}\n", 1 + 0.01 * i);
  BuildOptions options = adaptive(OctreeBuild::tracing);
  options.octree_depth = kMostOctreeDepth;
  const CompiledScene deep = compile(test::load_yaml(test::view_text() + "scene:\n" + balls), options);
  FrameState state(deep.scene);
  std::mt19937 random(5);
  for (int i = 0; i < 200; ++i) {
    const Ray ray{test::random_point(random, 2), normalized(test::random_point(random, 1))};
    ASSERT_EQ(closest_hit(deep.scene, state.at(0), ray).t,
              closest_hit_brute_force(deep.scene, state.at(0), ray).t);
  }
  EXPECT_LE(storage_of(deep.scene, 0).pointers, 20 * (kMostPointersForEach + 8) + 4096);
}

TEST(GrowingOctree, MovesWithItsObject) {
  std::string balls;
  std::mt19937 random(8);
  for (int i = 0; i < 40; ++i) {
    const Vec3 c = test::random_point(random, 1);
    balls += fmt::format("      - {{sphere: {{center: [{}, {}, {}], radius: 0.3}}}}\n", c.x, c.y, c.z);
  }
  const CompiledScene compiled = compile(test::load_yaml(
      test::view_text() +
      "scene:\n  - structure: {adaptive: {max_primitives: 2, data: pointers, build: tracing}}\n"
      "    transform: {translate: {0: [0, 0, 0], 4: [3, 0, 0]}}\n    group:\n" +
      balls));
  ASSERT_EQ(compiled.scene.octrees.size(), 1u);
  EXPECT_EQ(compiled.scene.octrees[0].build, OctreeBuild::tracing);
  FrameState state(compiled.scene);
  int hits = 0;
  for (const double frame : {0.0, 4.0, 1.5})
    for (int i = 0; i < 200; ++i) {
      const Ray ray{test::random_point(random, 3), normalized(test::random_point(random, 1))};
      const Hit slow = closest_hit_brute_force(compiled.scene, state.at(frame), ray);
      ASSERT_EQ(closest_hit(compiled.scene, state.at(frame), ray).t, slow.t);
      hits += slow.is_hit();
    }
  EXPECT_GT(hits, 20);
  EXPECT_GT(storage_of(compiled.scene, 0).nodes, 10u);
}

TEST(GrowingOctree, DamagedOnesAreRefused) {
  const CompiledScene compiled = compile(test::make_mixed_scene(9, 1, 20), adaptive(OctreeBuild::tracing));
  const CompiledScene before = compile(test::make_mixed_scene(9, 1, 20), adaptive(OctreeBuild::before));
  const auto is_refused = [](const CompiledScene& of, const std::function<void(Octree&)>& damage) {
    Scene scene = of.scene;
    Octree octree = scene.octrees[0];
    damage(octree);
    scene.octrees = {&octree, 1};
    try {
      decode_scene(encode_scene(scene).bytes());
    } catch (const SceneBlockError&) {
      return true;
    }
    return false;
  };
  EXPECT_FALSE(is_refused(compiled, [](Octree&) {}));
  EXPECT_TRUE(is_refused(compiled, [](Octree& o) { o.build = OctreeBuild{2}; }));
  EXPECT_TRUE(is_refused(compiled, [](Octree& o) { o.max_primitives = 0; }));
  EXPECT_TRUE(is_refused(compiled, [](Octree& o) { o.cell_count = 0; }));
  EXPECT_TRUE(is_refused(before, [](Octree& o) { o.build = OctreeBuild::tracing; }));
}

TEST(GrowingOctree, ElsewhereTheSwitchIsNoted) {
  const CompiledScene sah = compile(test::make_mixed_scene(9, 1, 20), {.octree_build = OctreeBuild::tracing});
  ASSERT_EQ(sah.notes.lines().size(), 1u);
  EXPECT_NE(sah.notes.lines()[0].find("belong to an `adaptive` hierarchy"), std::string::npos);
}

}  // namespace
}  // namespace rayfarm
