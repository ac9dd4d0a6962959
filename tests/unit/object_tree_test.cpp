// Hierarchies of objects: what nodes there are, and what rays visit.
#include "common/hierarchy/bounding_tree.h"
#include "common/hierarchy/traverser.h"
#include "common/hierarchy/walk_counts.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

CompiledScene compile_objects(const std::string& scene, const ObjectOptions& objects = {}) {
  return compile(test::load_yaml(test::view_text() + "scene:\n" + scene),
                 {.hierarchy = Hierarchy::object, .objects = objects});
}

/// Five balls of radius 0.4 at x = 0, 1, …, each an object with a sphere about it.
std::string row_text() {
  std::string text;
  for (int i = 0; i < 5; ++i)
    text += fmt::format("  - {{name: ball {}, bound: sphere, sphere: {{center: [{}, 0, 0], radius: 0.4}}}}\n",
                        i, i);
  return text;
}

WalkCounts counts_of(const CompiledScene& compiled, const Ray& ray) {
  FrameState state(compiled.scene);
  WalkCounts counts;
  const Hit hit = closest_hit_counted(compiled.scene, state.at(0), ray, counts);
  const Hit expected = closest_hit_brute_force(compiled.scene, state.at(0), ray);
  EXPECT_EQ(hit.t, expected.t);
  EXPECT_EQ(hit.primitive, expected.primitive);
  return counts;
}

ObjectSizes sizes_of(const CompiledScene& compiled) {
  return sizes_of(compiled.scene, compiled.scene.bounding_trees[compiled.scene.head().object_tree]);
}

// Thesis Table 4.5, object hierarchy: nodes, pointers and bytes of the three test images.
TEST(ObjectTree, TheThesissImagesHaveTheNodesPointersAndBytesOfTable45) {
  const auto expect = [](const std::string& name, uint64_t nodes, uint64_t pointers, uint64_t bytes) {
    const CompiledScene compiled =
        compile(load_scene(RAYFARM_SOURCE "/scenes/hierarchies/" + name), {.hierarchy = Hierarchy::object});
    const ObjectSizes sizes = sizes_of(compiled);
    EXPECT_EQ(sizes.nodes, nodes) << name;
    EXPECT_EQ(sizes.pointers, pointers) << name;
    EXPECT_EQ(sizes.bytes(), bytes) << name;
  };
  expect("beach_house.yaml", 15, 14, 1376);
  expect("primitives.yaml", 20, 19, 1836);
  expect("plant.yaml", 13, 12, 1192);
}

// Thesis Figure 4.4: "While( There is Another Child Closer then Current_Prim )"; and Figure 2.15, which looks
// into all.
TEST(ObjectTree, SortedVolumesEndAtTheHitAndUnsortedOnesDoNot) {
  const Ray along{Vec3(-5, 0, 0), Vec3(1, 0, 0)};
  const WalkCounts sorted = counts_of(compile_objects(row_text()), along);
  EXPECT_EQ(sorted.groups, 1u);
  EXPECT_EQ(sorted.bounding_volumes(), 6u) << "the scene's, and the five in it";
  EXPECT_GE(sorted.bounds[0], 5u);
  EXPECT_EQ(sorted.objects, 1u);
  EXPECT_EQ(sorted.spheres, 1u);
  const WalkCounts all = counts_of(compile_objects(row_text(), {.order = ObjectOrder::all}), along);
  EXPECT_EQ(all.bounding_volumes(), 6u);
  EXPECT_EQ(all.objects, 5u);
  EXPECT_EQ(all.spheres, 5u);
}

// Thesis 2.6.1: "the hierarchy below this node can be pruned".
TEST(ObjectTree, WhatLiesInAVolumeThatIsMissedIsNotLookedAt) {
  const WalkCounts counts = counts_of(compile_objects(row_text()), {Vec3(-5, 3, 0), Vec3(1, 0, 0)});
  EXPECT_EQ(counts.bounding_volumes(), 1u);
  EXPECT_EQ(counts.groups + counts.objects + counts.primitives(), 0u);
}

// Weghorst, Hooper and Greenberg, Equation 1: items are tested i ≤ b times, b of their volumes'.
TEST(ObjectTree, ItemsAreTestedNoMoreOftenThanTheirVolumes) {
  const CompiledScene compiled = compile_objects(row_text());
  FrameState state(compiled.scene);
  WalkCounts counts;
  std::mt19937 random(3);
  for (int i = 0; i < 200; ++i)
    closest_hit_counted(compiled.scene, state.at(0),
                        {test::random_point(random, 4), normalized(test::random_point(random, 1))}, counts);
  EXPECT_GT(counts.objects, 0u);
  EXPECT_LE(counts.objects, counts.bounding_volumes());
}

TEST(ObjectTree, OneOfSeveralVolumesThatIsMissedIsEnough) {
  const std::string pole = R"(  - name: pole
    bound: [sphere, cylinder]
    group:
      - {cylinder: {base: [0, -3, 0], top: [0, 3, 0], radius: 0.2}}
      - {sphere: {center: [0, 3, 0], radius: 0.2}}
)";
  const CompiledScene compiled = compile_objects(pole);
  const auto bounds = [&](const Ray& ray) { return counts_of(compiled, ray).bounds; };
  EXPECT_EQ(bounds({Vec3(-9, 8, 0), Vec3(1, 0, 0)}), (std::array<uint64_t, 4>{1, 0, 0, 0}));
  EXPECT_EQ(bounds({Vec3(-9, 0, 2), Vec3(1, 0, 0)}), (std::array<uint64_t, 4>{1, 0, 1, 0}));
  EXPECT_EQ(counts_of(compiled, {Vec3(-9, 0, 2), Vec3(1, 0, 0)}).objects, 0u);
  EXPECT_EQ(counts_of(compiled, {Vec3(-9, 0, 0), Vec3(1, 0, 0)}).objects, 1u);
}

// Weghorst, Hooper and Greenberg, 2: "spheres, cylinders, and rectangular parallelepipeds, do not require" a
// volume; 3: "clusters containing only one element are removed".
TEST(ObjectTree, SimpleItemsHaveNoVolumesAndGroupsOfOneAreNone) {
  const CompiledScene compiled = compile_objects(R"(  - {name: ball, sphere: {center: [0, 0, 0], radius: 1}}
  - {name: pipe, cylinder: {base: [3, 0, 0], top: [3, 2, 0], radius: 0.5}}
  - {name: crate, transform: {rotate: {axis: [0, 1, 0], degrees: 30}}, box: {min: [5, 0, 0], max: [6, 1, 1]}}
  - name: outer
    group:
      - name: inner
        group: [{name: tip, lathe: {profile: [[0, 0], [1, 0], [0, 2]], sides: 7}}]
)");
  const Scene& scene = compiled.scene;
  EXPECT_EQ(sizes_of(compiled).nodes, 5u);
  EXPECT_EQ(sizes_of(compiled).pointers, 4u);
  const BoundingNode& root = scene.bounding_nodes[scene.bounding_trees[scene.head().object_tree].root];
  std::vector<uint32_t> volumes;
  for (const BoundingNode& node : scene.bounding_nodes.subspan(root.first_child, root.child_count))
    volumes.push_back(node.volume_count);
  EXPECT_EQ(volumes, (std::vector<uint32_t>{0, 0, 0, 1}));
}

/// Sixteen small pyramids in four heaps far from each other, and a floor below all of them.
std::string heaps_text() {
  std::string text =
      "  - {name: floor, polygon: {points: [[-9, 0, 30], [30, 0, 30], [30, 0, -9], [-9, 0, -9]]}}\n";
  for (int i = 0; i < 16; ++i)
    text += fmt::format(
        "  - {{name: p{}, transform: {{translate: [{}, 0, {}]}}, lathe: {{profile: [[0, 0], [1, 0], [0, 2]], "
        "sides: 5}}}}\n",
        i, i % 2 * 20 + i / 4 % 2 * 3, i / 2 % 2 * 20 + i / 8 * 3);
  return text;
}

// Weghorst, Hooper and Greenberg, 3: "Groups of items, which are in close proximity to each other".
TEST(ObjectTree, NearObjectsAreClusteredAndLargeOnesStandAlone) {
  const CompiledScene flat = compile_objects(heaps_text(), {.clusters = Clusters::none}),
                      clustered = compile_objects(heaps_text(), {.clusters = Clusters::automatic});
  EXPECT_EQ(sizes_of(flat).nodes, 18u);
  EXPECT_EQ(sizes_of(clustered).nodes, 22u) << "four clusters of four";
  EXPECT_EQ(sizes_of(clustered).pointers, 21u);
  const Ray ray{Vec3(0.2, 9, 0.1), Vec3(0, -1, 0)};
  EXPECT_LT(counts_of(clustered, ray).bounding_volumes(), counts_of(flat, ray).bounding_volumes());
}

TEST(ObjectTree, GroupsOfTheSceneMayBeLeftOut) {
  const std::string groups = R"(  - name: a
    group: [{name: x, sphere: {center: [0, 0, 0], radius: 1}}, {name: y, sphere: {center: [2, 0, 0], radius: 1}}]
  - {name: z, sphere: {center: [9, 0, 0], radius: 1}}
)";
  EXPECT_EQ(sizes_of(compile_objects(groups)).nodes, 5u);
  EXPECT_EQ(sizes_of(compile_objects(groups, {.clusters = Clusters::none})).nodes, 4u);
}

TEST(ObjectTree, EveryKindOfVolumeOrderAndClusterAnswersAsBruteForce) {
  const SceneDescription office = load_scene(RAYFARM_SOURCE "/scenes/hierarchies/office.yaml");
  std::vector<ObjectOptions> choices;
  for (int kind = 0; kind < 5; ++kind) choices.push_back({.bounds = static_cast<BoundChoice>(kind)});
  choices.push_back({.order = ObjectOrder::all});
  choices.push_back({.clusters = Clusters::none});
  choices.push_back({.clusters = Clusters::automatic});
  choices.push_back({.bounds_for = BoundsFor::eye});
  for (const ObjectOptions& objects : choices) {
    const CompiledScene compiled = compile(office, {.hierarchy = Hierarchy::object, .objects = objects});
    FrameState state(compiled.scene);
    Box box;
    for (const InstancePose& pose : compiled.scene.poses) box.grow(pose.bounds);
    std::mt19937 random(5);
    for (int i = 0; i < 150; ++i) {
      const Vec3 origin = box.center() + test::random_point(random, 0.6) * box.extent();
      const Ray ray{origin, normalized(test::random_point(random, 1))};
      const Hit slow = closest_hit_brute_force(compiled.scene, state.at(0), ray),
                fast = closest_hit(compiled.scene, state.at(0), ray);
      ASSERT_EQ(fast.t, slow.t);
      ASSERT_EQ(fast.primitive, slow.primitive);
      ASSERT_EQ(fast.instance, slow.instance);
      ASSERT_EQ(any_hit(compiled.scene, state.at(0), ray), slow.is_hit());
    }
  }
}

// What moves stays below boxes that are refitted; what is in it has its own volumes.
TEST(ObjectTree, MovingObjectsAndStillOnesAreBothFound) {
  const CompiledScene compiled = compile(
      test::load_yaml(
          test::view_text() + "frames: [0, 4]\nscene:\n" + row_text() +
          "  - {name: mover, transform: {translate: {0: [0, 2, 0], 4: [8, 2, 0]}}, bound: box, sphere: "
          "{center: [0, 0, 0], radius: 0.5}}\n"),
      {.hierarchy = Hierarchy::object});
  FrameState state(compiled.scene);
  for (const int frame : {0, 2, 4})
    for (const double y : {0.0, 2.0}) {
      const Ray ray{Vec3(-5, y, 0), Vec3(1, 0, 0)};
      const Pose pose = state.at(frame);
      EXPECT_TRUE(closest_hit(compiled.scene, pose, ray).is_hit());
      EXPECT_EQ(closest_hit(compiled.scene, pose, ray).t,
                closest_hit_brute_force(compiled.scene, pose, ray).t);
    }
}

TEST(ObjectTree, ARayFromVeryFarAwayMissesNothing) {
  const CompiledScene row = compile_objects(row_text());
  FrameState state(row.scene);
  const Vec3 origin(-1e9, 3e8, 2e8);
  for (int i = 0; i < 5; ++i) {
    const Ray ray{origin, normalized(Vec3(i, 0, 0) - origin)};
    EXPECT_EQ(closest_hit(row.scene, state.at(0), ray).t,
              closest_hit_brute_force(row.scene, state.at(0), ray).t);
  }
}

TEST(ObjectTree, NotesAndMistakes) {
  const std::string ball = "{name: ball, bound: box, sphere: {center: [0, 0, 0], radius: 1}}";
  EXPECT_NE(test::notes_of(test::view_text() + "scene: [" + ball + "]\n").find("`bound` of 1 object"),
            std::string::npos);
  const CompiledScene idle =
      compile(test::load_yaml(test::view_text() + "scene: [{sphere: {center: [0, 0, 0], radius: 1}}]\n"),
              {.objects = {.bounds = BoundChoice::box}});
  ASSERT_EQ(idle.notes.lines().size(), 1u);
  EXPECT_NE(idle.notes.lines()[0].find("belongs to an `object` hierarchy"), std::string::npos);
  EXPECT_TRUE(compile_objects("  - " + ball + "\n").notes.lines().empty());
  const auto note_of = [](const std::string& scene, const ObjectOptions& objects) {
    const std::vector<std::string> lines = compile_objects(scene, objects).notes.lines();
    return lines.size() == 1 ? lines[0] : "";
  };
  EXPECT_NE(note_of("  - {bound: box, group: [" + ball + ", {name: b, use: ball}]}\nobjects: {ball: [" +
                        ball + "]}\n",
                    {.clusters = Clusters::none})
                .find("`bound` of 1 group"),
            std::string::npos);
  EXPECT_NE(note_of("  - " + ball + "\n", {.bounds = BoundChoice::box, .bounds_for = BoundsFor::eye})
                .find("the eye"),
            std::string::npos);
  const auto error_of = [](const std::string& bound) {
    return test::error_of(test::view_text() + "scene: [{bound: " + bound +
                          ", sphere: {center: [0, 0, 0], radius: 1}}]\n");
  };
  EXPECT_NE(error_of("cone").find("cone"), std::string::npos);
  EXPECT_NE(error_of("[]").find("one to four"), std::string::npos);
  EXPECT_NE(error_of("[sphere, none]").find("stands alone"), std::string::npos);
  EXPECT_EQ(error_of("[sphere, slabs]"), "");
}

TEST(ObjectTree, BoundsOfNodesThatOnlyMoveWhatIsUsedElsewhereAreNoted) {
  const std::string pair =
      "objects: {pair: [{sphere: {center: [0, 0, 0], radius: 1}}, {sphere: {center: [3, 0, 0], radius: "
      "1}}]}\n";
  const auto notes = [&](const std::string& transform) {
    const CompiledScene compiled = compile(
        test::load_yaml(test::view_text() + pair + "scene:\n  - {bound: cylinder, use: pair, transform: " +
                        transform + "}\n  - {use: pair, transform: {translate: [0, 9, 0]}}\n"),
        {.hierarchy = Hierarchy::object});
    return test::notes_of(compiled);
  };
  const std::string note = "`bound` of 1 object changes nothing here: what it has is used in several places";
  EXPECT_NE(notes("{translate: {0: [0, 0, 0], 4: [0, 0, 1]}}").find(note), std::string::npos);
  EXPECT_EQ(notes("{translate: [0, 0, 1]}").find(note), std::string::npos);
}

TEST(ObjectTree, BoundsThatAGroupOfOneOrOfNoClusterHasAreNoted) {
  const auto notes = [](const std::string& scene, Clusters clusters) {
    const CompiledScene compiled =
        compile(test::load_yaml(test::view_text() + "scene:\n" + scene),
                {.hierarchy = Hierarchy::object, .objects = {.clusters = clusters}});
    return test::notes_of(compiled);
  };
  const std::string two =
      "[{sphere: {center: [0, 0, 0], radius: 1}}, {sphere: {center: [3, 0, 0], radius: 1}}]";
  const std::string other = "  - {name: other, group: " + two + "}\n";
  const std::string both =
      "  - {name: g, bound: box, group: [{name: a, bound: sphere, group: " + two + "}]}\n" + other;
  EXPECT_NE(notes(both, Clusters::groups).find("`bound` of 1 object changes nothing"), std::string::npos);
  const std::string outer = "  - {name: g, bound: box, group: [{name: a, group: " + two + "}]}\n" + other;
  EXPECT_EQ(notes(outer, Clusters::groups).find("`bound`"), std::string::npos);
  const std::string mixed =
      "  - {name: g, bound: box, group: [{sphere: {center: [9, 0, 0], radius: 1}}, {name: a, group: " + two +
      "}]}\n" + other;
  EXPECT_EQ(notes(mixed, Clusters::groups).find("`bound`"), std::string::npos);
  EXPECT_NE(notes(mixed, Clusters::none).find("`bound` of 1 group changes nothing"), std::string::npos);
}

}  // namespace
}  // namespace rayfarm
