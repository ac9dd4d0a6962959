// The object/volume hierarchy as the thesis stores and walks it: one sphere a volume, octants in Table 4.2's
// order.
#include "common/hierarchy/octant_tree.h"

#include "common/hierarchy/octants.h"
#include "common/hierarchy/storage.h"
#include "common/hierarchy/traverser.h"
#include "common/hierarchy/walk_counts.h"
#include "common/scene/references.h"
#include "tests/unit/damaged_scene.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

constexpr ThesisOptions kSpheres{.volumes = ThesisVolumes::spheres, .clip = ThesisClip::always};

std::string ball(double x, double y, double z, double radius) {
  return fmt::format("  - {{sphere: {{center: [{}, {}, {}], radius: {}}}}}\n", x, y, z, radius);
}

CompiledScene compile_nodes(const std::string& nodes, uint32_t max_primitives,
                            const ThesisOptions& thesis = kSpheres) {
  return compile(test::load_yaml(test::view_text() + "scene:\n" + nodes),
                 {.hierarchy = Hierarchy::thesis, .max_primitives = max_primitives, .thesis = thesis});
}

WalkCounts count(const CompiledScene& compiled, const Ray& ray) {
  FrameState state(compiled.scene);
  WalkCounts counts;
  closest_hit_counted(compiled.scene, state.at(0), ray, counts);
  return counts;
}

void expect_brute_force(const CompiledScene& compiled, const Ray& ray) {
  FrameState state(compiled.scene);
  const Hit slow = closest_hit_brute_force(compiled.scene, state.at(0), ray),
            fast = closest_hit(compiled.scene, state.at(0), ray);
  ASSERT_EQ(fast.t, slow.t);
  ASSERT_EQ(fast.primitive, slow.primitive);
  ASSERT_EQ(any_hit(compiled.scene, state.at(0), ray), slow.is_hit());
}

void expect_brute_force(const CompiledScene& compiled, int rays, double size, double origin_scale = 1) {
  std::mt19937 random(5);
  for (int i = 0; i < rays; ++i) {
    const Vec3 origin = origin_scale * test::random_point(random, size);
    expect_brute_force(compiled, {origin, normalized(test::random_point(random, size) - origin)});
  }
}

/// A line of Table 4.2: how far the planes across x, y, z are (-1: "undefined"), and what is to be changed of
/// the octant's number. Relations 6 to 8, 10, 15 and 16, misprinted in the thesis, as the others demand.
struct Line {
  Vec3 t;
  std::vector<uint32_t> changes;
};
const std::vector<Line> kTable4_2{
    {{-1, -1, -1}, {}},     {{-1, -1, 1}, {1}},     {{-1, 1, -1}, {2}},     {{1, -1, -1}, {4}},
    {{-1, 1, 2}, {2, 1}},   {{-1, 2, 1}, {1, 2}},   {{1, -1, 2}, {4, 1}},   {{2, -1, 1}, {1, 4}},
    {{1, 2, -1}, {4, 2}},   {{2, 1, -1}, {2, 4}},   {{1, 2, 3}, {4, 2, 1}}, {{1, 3, 2}, {4, 1, 2}},
    {{2, 1, 3}, {2, 4, 1}}, {{3, 1, 2}, {2, 1, 4}}, {{2, 3, 1}, {1, 4, 2}}, {{3, 2, 1}, {1, 2, 4}}};

// Thesis 4.2.2, Table 4.2: "The next subvolume entered is dependent on the current subvolume and the order in
// which the planes are crossed"; 4.2.1.2, Table 4.1. An undefined t is that of a parallel ray or a negative
// one.
TEST(OctantOrder, IsThatOfTable4_2FromEveryOctant) {
  const Vec3 center(0.5, -2, 8);
  for (const Line& line : kTable4_2)
    for (uint32_t start = 0; start < 8; ++start)
      for (const double undefined : {0.0, 1.0}) {
        const Vec3 side(start & 4 ? -1 : 1, start & 2 ? -1 : 1, start & 1 ? -1 : 1);
        Vec3 origin, direction;
        for (int axis = 0; axis < 3; ++axis) {
          origin[axis] = center[axis] + side[axis] * std::abs(line.t[axis]);
          direction[axis] = side[axis] * (line.t[axis] < 0 ? undefined : -1);
        }
        const OctantOrder order(center, origin, direction);
        ASSERT_EQ(order.count, 1 + line.changes.size());
        EXPECT_EQ(order.octants[0], start);
        EXPECT_EQ(order.entries[0], 0);
        for (size_t i = 0; i < line.changes.size(); ++i) {
          EXPECT_EQ(order.octants[i + 1], order.octants[i] ^ line.changes[i]);
          EXPECT_EQ(order.entries[i + 1], line.t[line.changes[i] == 4 ? 0 : line.changes[i] == 2 ? 1 : 2]);
        }
      }
}

// The thesis's example: child 3 and t_x < t_y < t_z. It prints 3, 7, 1, 2, adding modulo 8; 7 and 1 do not
// touch.
TEST(OctantOrder, OfTheExampleGoesFromNeighbourToNeighbour) {
  const OctantOrder order(Vec3(0), Vec3(1, -2, -3), Vec3(-1, 1, 1));
  EXPECT_EQ(order.octants, (std::array<uint32_t, 4>{3, 7, 5, 4}));
}

TEST(OctantOrder, IsWhereThePointsOfTheRayAre) {
  std::mt19937 random(3);
  for (int i = 0; i < 500; ++i) {
    const Vec3 center = test::random_point(random, 1), origin = test::random_point(random, 1),
               direction = test::random_point(random, 1);
    const OctantOrder order(center, origin, direction);
    for (size_t k = 0; k < order.count; ++k) {
      const double end = k + 1 < order.count ? order.entries[k + 1] : order.entries[k] + 2,
                   t = 0.5 * (order.entries[k] + end);
      if (end - order.entries[k] < 1e-9) continue;
      const Vec3 p = origin + t * direction;
      EXPECT_EQ(order.octants[k],
                (p.x < center.x ? 4u : 0u) | (p.y < center.y ? 2u : 0u) | (p.z < center.z ? 1u : 0u));
    }
  }
}

// Where t is 0 the ray crosses the plane if it goes below it; Table 4.2's "≥ 0" would lead one away that
// rises.
TEST(OctantOrder, ARayThatBeginsInAPlaneCrossesItDownwardOnly) {
  EXPECT_EQ(OctantOrder(Vec3(0), Vec3(0, 1, 1), Vec3(1, 0, 0)).count, 1u);
  const OctantOrder down(Vec3(0), Vec3(0, 1, 1), Vec3(-1, 0, 0));
  EXPECT_EQ(down.count, 2u);
  EXPECT_EQ(down.octants[1], 4u);
  EXPECT_EQ(down.entries[1], 0);
}

// Thesis 4.2.1.2: "The center of the data at a node is used as the origin of the local coordinate system";
// "Each child contains only the data which falls in its assigned subvolume"; 4.3.2: a sphere each.
TEST(OctantTree, VolumesAreSpheresAboutTheirDataAndLeavesListThem) {
  const CompiledScene two = compile_nodes(ball(1, 1, 1, 0.1) + ball(-1, -1, -1, 0.1), 1);
  const Scene& s = two.scene;
  ASSERT_EQ(s.octant_trees.size(), 1u);
  ASSERT_EQ(s.octant_volumes.size(), 3u);
  const OctantVolume &root = s.octant_volumes[0], &above = s.octant_volumes[1], &below = s.octant_volumes[2];
  EXPECT_EQ(root.octants, 1u << 0 | 1u << 7);
  EXPECT_EQ(root.first, 1u);
  EXPECT_NEAR(glm::length(root.center), 0, 1e-6);
  EXPECT_NEAR(root.radius, 1.1 * std::sqrt(3), 1e-6);
  EXPECT_NEAR(glm::length(above.center - Vec3(1)), 0, 1e-6);
  EXPECT_NEAR(glm::length(below.center + Vec3(1)), 0, 1e-6);
  EXPECT_GT(above.radius, 0.1);
  EXPECT_NEAR(above.radius, 0.1 * std::sqrt(3), 1e-6);
  for (const OctantVolume& leaf : {above, below}) {
    EXPECT_TRUE(leaf.is_leaf());
    EXPECT_EQ(leaf.pointer_count, 1u);
  }
  const PrimitivePointer p = s.primitive_pointers[below.first];
  EXPECT_EQ(s.sphere_blocks[p.place() / 8].spheres[p.place() % 8], 1u);
}

// "Centre of the data" (4.2.1.2) may be the mean of its parts, or the middle of its box.
TEST(OctantTree, IsDividedAboutTheMeanOrTheMiddle) {
  const std::string balls = ball(0, 0, 0, 0.1) + ball(1, 0, 0, 0.1) + ball(5, 0, 3, 0.1);
  ThesisOptions options = kSpheres;
  EXPECT_NEAR(glm::length(compile_nodes(balls, 1, options).scene.octant_volumes[0].center - Vec3(2, 0, 1)), 0,
              1e-6);
  options.center = ThesisCenter::volume;
  EXPECT_NEAR(
      glm::length(compile_nodes(balls, 1, options).scene.octant_volumes[0].center - Vec3(2.5, 0, 1.5)), 0,
      1e-6);
}

// Thesis 4.3.3: N_V is "the number of volume nodes visited", N_P that of primitives tested.
TEST(OctantTree, RaysVisitWhatTable4_2NamesUntilTheyHit) {
  const CompiledScene two = compile_nodes(ball(1, 1, 1, 0.1) + ball(-1, -1, -1, 0.1), 1);
  const WalkCounts hit = count(two, {Vec3(3, 1, 1), Vec3(-1, 0, 0)});
  EXPECT_EQ(hit.interior_volumes, 1u);
  EXPECT_EQ(hit.leaf_volumes, 1u);
  EXPECT_EQ(hit.missed_volumes, 0u);
  EXPECT_EQ(hit.primitives(), 1u);
  EXPECT_EQ(hit.cells, 0u);
  const WalkCounts through = count(two, {Vec3(1.5, 1.6, 1.5), Vec3(-1, -1, -1)});
  EXPECT_EQ(through.volumes(), 2u) << "hits the first ball, and does not look into the octant of the second";
  const WalkCounts between = count(two, {Vec3(0.5, 0.5, 0.5), Vec3(-1, -1, -1)});
  EXPECT_EQ(between.volumes(), 3u);
  EXPECT_EQ(between.missed_volumes, 1u) << "the first octant's sphere lies behind";
  EXPECT_EQ(between.primitives(), 1u);
  const WalkCounts past = count(two, {Vec3(3, 3, 1), Vec3(-1, 0, 0)});
  EXPECT_EQ(past.volumes(), 1u);
  EXPECT_EQ(past.missed_volumes, 1u);
}

// Lists hold whole primitives: "no primitive has been found" (Figure 4.4) must not count a hit beyond the
// octant.
TEST(OctantTree, AHitBeyondTheOctantDoesNotEndTheSearch) {
  // About (0, 0, 0): the wall is listed beside the second ball in the ray's first octant, whose sphere the
  // ray meets, and hit in the next, where the first ball stands before it.
  const std::string wall = "  - {polygon: {points: [[-9, 9, 3], [9, 9, 3], [9, -9, -9], [-9, -9, -9]]}}\n";
  const CompiledScene compiled =
      compile_nodes(wall + ball(3, 3, -0.5, 0.3) + ball(8, 8, 8, 1), 2,
                    {ThesisVolumes::spheres, ThesisClip::always, ThesisCenter::volume});
  FrameState state(compiled.scene);
  WalkCounts counts;
  const Hit hit = closest_hit_counted(compiled.scene, state.at(0), {Vec3(3, 3, 10), Vec3(0, 0, -1)}, counts);
  EXPECT_EQ(hit.primitive, make_primitive_id(PrimitiveKind::sphere, 0));
  EXPECT_NEAR(hit.t, 10.2, 1e-9);
  EXPECT_EQ(counts.polygons, 2u) << "the wall, in both";
  expect_brute_force(compiled, 1000, 10);
}

TEST(OctantTree, EverySwitchGivesTheHitsOfBruteForce) {
  for (const double scale : {1e-3, 1.0, 1e6}) {
    const SceneDescription mixed = test::make_mixed_scene(9, scale, 80);
    for (const ThesisVolumes volumes : {ThesisVolumes::spheres, ThesisVolumes::boxes})
      for (const ThesisClip clip : {ThesisClip::bounded, ThesisClip::always})
        for (const ThesisCenter center : {ThesisCenter::data, ThesisCenter::volume})
          for (const bool has_mailbox : {false, true})
            expect_brute_force(compile(mixed, {.hierarchy = Hierarchy::thesis,
                                               .max_primitives = 2,
                                               .thesis = {volumes, clip, center},
                                               .has_mailbox = has_mailbox}),
                               100, 2 * scale);
  }
}

// Rounding on the way of a ray from very far away is larger than what spheres are widened by: it tests all.
TEST(OctantTree, ARayFromVeryFarAwayMissesNothing) {
  const CompiledScene compiled =
      compile(test::make_mixed_scene(9, 1, 80),
              {.hierarchy = Hierarchy::thesis, .max_primitives = 2, .thesis = kSpheres});
  for (const double distance : {1e3, 1e6, 1e9}) expect_brute_force(compiled, 200, 1, distance);
}

/// Twice a cube's faces, and a ball: divided about 0, where all of them meet or touch.
TEST(OctantTree, RaysInThePlanesOfDivisionMissNothing) {
  std::string nodes = ball(0, 0, 0, 0.5);
  for (int copy = 0; copy < 2; ++copy)
    for (const double k : {-1.0, 0.0, 1.0})
      nodes += fmt::format(
          "  - {{polygon: {{points: [[{0}, -1, -1], [{0}, 1, -1], [{0}, 1, 1], [{0}, -1, 1]]}}}}\n"
          "  - {{polygon: {{points: [[-1, {0}, -1], [0, {0}, -1], [0, {0}, 1], [-1, {0}, 1]]}}}}\n"
          "  - {{polygon: {{points: [[-1, -1, {0}], [1, -1, {0}], [1, 0, {0}], [-1, 0, {0}]]}}}}\n",
          k);
  const CompiledScene compiled =
      compile_nodes(nodes, 1, {ThesisVolumes::spheres, ThesisClip::always, ThesisCenter::volume});
  EXPECT_GT(compiled.scene.octant_volumes.size(), 8u);
  const std::array places{-2.0, -1.0, -0.5, 0.0, 0.5, 1.0};
  for (const double x : places)
    for (const double y : places)
      for (const double z : places)
        for (const Vec3& d :
             {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, -0.0), Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(0, 0, -1),
              Vec3(1, 1, 0), Vec3(0, -1, 1), Vec3(-1, -1, -1), Vec3(1, -1, 1)})
          expect_brute_force(compiled, {Vec3(x, y, z), d});
}

uint64_t pointers_of(const CompiledScene& compiled) {
  uint64_t count = 0;
  for_each_reference(compiled.scene, [&](PrimitiveId) { ++count; });
  return compiled.scene.octant_trees.empty() ? count : storage_of_octants(compiled.scene).pointers;
}

// Thesis 4.2.1.2: "Each child contains only the data which falls in its assigned subvolume"; Table 4.10's
// primitives are 1.8 to 8.0 times as many after clipping.
TEST(OctantTree, ClippingAlwaysListsAPrimitiveInEveryOctantThatItIsIn) {
  const std::string tiles =
      "  - {polygon: {points: [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1]]}}\n"
      "  - {polygon: {points: [[-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]]}}\n";
  for (const ThesisVolumes volumes : {ThesisVolumes::spheres, ThesisVolumes::boxes}) {
    const CompiledScene bounded = compile_nodes(tiles, 1, {.volumes = volumes}),
                        always = compile_nodes(tiles, 1, {.volumes = volumes, .clip = ThesisClip::always});
    const uint64_t triangles = volumes == ThesisVolumes::boxes ? 2 : 1;  // the pieces that boxes refer to
    EXPECT_EQ(pointers_of(bounded), 2 * triangles);
    EXPECT_GE(pointers_of(always), 8u);  // a quarter of a tile in each of the eight octants
    expect_brute_force(always, 500, 2);
  }
  const CompiledScene spheres = compile_nodes(tiles, 1);
  EXPECT_EQ(spheres.scene.octant_volumes[0].octants, 0xffu);
  const OctantStorage storage = storage_of_octants(spheres.scene);
  EXPECT_EQ(storage.interior, 1u);
  EXPECT_EQ(storage.leaves, 8u);
  EXPECT_EQ(storage.pointers, 8u);
}

/// No division parts them; it ends all the same.
TEST(OctantTree, PrimitivesInOnePlaceEndTheDivision) {
  std::string balls;
  for (int i = 0; i < 20; ++i) balls += ball(0, 0, 0, 1);
  for (const ThesisVolumes volumes : {ThesisVolumes::spheres, ThesisVolumes::boxes}) {
    const CompiledScene compiled = compile_nodes(balls, 4, {.volumes = volumes, .clip = ThesisClip::always});
    EXPECT_LE(pointers_of(compiled), 20 * static_cast<uint64_t>(OctantDivider::kMostGrowth));
    expect_brute_force(compiled, 100, 2);
  }
}

// Shirley, Sung and Brown, 2.3.3: a mailbox avoids testing again what was tested in another volume.
TEST(OctantTree, AMailboxSavesTestsOfWhatSeveralVolumesList) {
  const SceneDescription mixed = test::make_mixed_scene(3, 1, 60);
  const auto compiled = [&](bool has_mailbox) {
    return compile(mixed, {.hierarchy = Hierarchy::thesis,
                           .max_primitives = 2,
                           .thesis = kSpheres,
                           .has_mailbox = has_mailbox});
  };
  const CompiledScene without = compiled(false), with = compiled(true);
  std::mt19937 random(8);
  uint64_t saved = 0;
  for (int i = 0; i < 200; ++i) {
    const Ray ray{test::random_point(random, 2), normalized(test::random_point(random, 1))};
    const WalkCounts all = count(without, ray), once = count(with, ray);
    EXPECT_EQ(once.primitives() + once.saved_tests, all.primitives());
    EXPECT_EQ(once.volumes(), all.volumes());
    saved += once.saved_tests;
  }
  EXPECT_GT(saved, 0u);
}

// Thesis, Tables 4.4 and 4.5: object nodes of 88 bytes, interior volumes of 24, leaves of 20, pointers of 4.
TEST(OctantTree, BytesAreThoseOfTable4_5) {
  struct Row {
    uint64_t objects;
    OctantStorage volumes;
    uint64_t bytes;
  };
  for (const Row& row :
       {Row{15, {53, 278, 3067}, 20420}, Row{15, {146, 753, 4816}, 39148}, Row{15, {296, 1569, 6948}, 67596},
        Row{20, {0, 1, 58}, 2012}, Row{13, {188, 1110, 8994}, 63832}, Row{13, {497, 2803, 14017}, 125200},
        Row{13, {953, 5656, 21677}, 223844}})
    EXPECT_EQ(88 * row.objects + row.volumes.bytes(), row.bytes);
  const CompiledScene two = compile_nodes(ball(1, 1, 1, 0.1) + ball(-1, -1, -1, 0.1), 1);
  EXPECT_EQ(storage_of(two.scene, two.scene.octant_trees[0]).bytes(), 24u + 2 * 20 + 2 * 4);
  EXPECT_EQ(storage_of_octants(two.scene).longest_list, 1u);
}

TEST(OctantTree, DamagedOnesAreRefused) {
  const CompiledScene two = compile_nodes(ball(1, 1, 1, 0.1) + ball(-1, -1, -1, 0.1), 1);
  decode_scene(encode_scene(two.scene).bytes());
  const auto of_tree = [&](const std::function<void(OctantTree&)>& damage, const char* what) {
    test::expect_refusal_at<OctantTree>(two, &Scene::octant_trees, damage, what);
  };
  of_tree([](OctantTree& t) { t.volume_count = 4; }, "more volumes than there are");
  of_tree([](OctantTree& t) { t.volume_count = 0; }, "no root");
  of_tree([](OctantTree& t) { t.first_volume = 1; }, "volumes that end too late");
  of_tree([](OctantTree& t) { t.magnitude = NAN; }, "no size");
  const auto of_volume = [&](size_t i, const std::function<void(OctantVolume&)>& damage, const char* what) {
    test::expect_refusal_at<OctantVolume>(two, &Scene::octant_volumes, damage, what, i);
  };
  of_volume(
      0, [](OctantVolume& v) { v.first = 0; }, "a volume in itself");
  of_volume(
      0, [](OctantVolume& v) { v.first = 2; }, "an octant that is not there");
  of_volume(
      0, [](OctantVolume& v) { v.octants = 1; }, "a volume that is nobody's");
  of_volume(
      0, [](OctantVolume& v) { v.octants = 1u << 8 | 1; }, "a ninth octant");
  of_volume(
      0, [](OctantVolume& v) { v.center.y = NAN; }, "a sphere nowhere");
  of_volume(
      1, [](OctantVolume& v) { v.radius = -1; }, "a sphere of no size");
  of_volume(
      1, [](OctantVolume& v) { v.octants = 1, v.first = 2; }, "an octant of two");
  of_volume(
      2, [](OctantVolume& v) { v.pointer_count = 2; }, "a list that is too long");
  of_volume(
      2, [](OctantVolume& v) { v.first = 9; }, "a list elsewhere");
  test::expect_refusal_at<Part>(
      two, &Scene::parts, [](Part& part) { part.collection.octants = 1; }, "a part of no octants");
  test::expect_refusal_at<Part>(
      two, &Scene::parts, [](Part& part) { part.collection.structure = Structure::list; },
      "octants of a list");
}

TEST(OctantTree, NotesSayWhatChangesNothing) {
  const SceneDescription scene =
      test::load_yaml(test::view_text() + "scene: [{sphere: {center: [0, 0, 0], radius: 1}}]\n");
  const auto has = [&](const BuildOptions& options, const std::string& words) {
    return test::notes_of(compile(scene, options)).find(words) != std::string::npos;
  };
  EXPECT_TRUE(has({.thesis = kSpheres}, "`thesis`"));
  EXPECT_TRUE(
      has({.hierarchy = Hierarchy::adaptive, .thesis = {.center = ThesisCenter::volume}}, "`thesis`"));
  EXPECT_TRUE(has({.hierarchy = Hierarchy::thesis, .has_mailbox = true}, "mailbox"));
  EXPECT_FALSE(has({.hierarchy = Hierarchy::thesis,
                    .max_primitives = 25,
                    .thesis = {ThesisVolumes::spheres, ThesisClip::always, ThesisCenter::volume},
                    .has_mailbox = true},
                   "changes nothing"));
}

}  // namespace
}  // namespace rayfarm
