// Octrees: which cells there are, what they hold, and how rays find them.
#include "common/hierarchy/octree.h"

#include "common/hierarchy/storage.h"
#include "common/hierarchy/traverser.h"
#include "common/hierarchy/walk_counts.h"
#include "tests/unit/damaged_scene.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

std::string ball(double x, double y, double z, double radius) {
  return fmt::format("  - {{sphere: {{center: [{}, {}, {}], radius: {}}}}}\n", x, y, z, radius);
}

CompiledScene compile_octree(const std::string& nodes, BuildOptions options) {
  options.hierarchy = Hierarchy::adaptive;
  return compile(test::load_yaml(test::view_text() + "scene:\n" + nodes), options);
}

/// Three balls in a cube of 4 × 4 × 4: two side by side at its near corner, one at the far corner.
CompiledScene make_three(OctreeNext next = OctreeNext::root, OctreeData data = OctreeData::hash) {
  return compile_octree(ball(0.45, 0.45, 0.45, 0.45) + ball(1.5, 0.45, 0.45, 0.4) + ball(3.5, 3.5, 3.5, 0.5),
                        {.max_primitives = 1, .octree_data = data, .octree_next = next});
}

WalkCounts count(const CompiledScene& compiled, const Ray& ray) {
  FrameState state(compiled.scene);
  WalkCounts counts;
  closest_hit_counted(compiled.scene, state.at(0), ray, counts);
  return counts;
}

void expect_brute_force(const CompiledScene& compiled, int rays, double size, double origin_scale = 1) {
  FrameState state(compiled.scene);
  std::mt19937 random(5);
  for (int i = 0; i < rays; ++i) {
    const Vec3 origin = origin_scale * test::random_point(random, size);
    const Ray ray{origin, normalized(test::random_point(random, size) - origin)};
    const Hit slow = closest_hit_brute_force(compiled.scene, state.at(0), ray),
              fast = closest_hit(compiled.scene, state.at(0), ray);
    ASSERT_EQ(fast.t, slow.t);
    ASSERT_EQ(fast.primitive, slow.primitive);
    ASSERT_EQ(any_hit(compiled.scene, state.at(0), ray), slow.is_hit());
  }
}

// Thesis 2.6.2, 4.3.1: "A construction tree is built … to record how the hierarchy was created"; "Each node
// consists of a size, center, a pointer to a child, a sibling pointer, and a flag indicating if the node was
// subdivided."
TEST(Octree, NodesAreDividedAboutTheirCentresAndOctantsWithoutDataHaveNone) {
  const CompiledScene three = make_three();
  const Scene& s = three.scene;
  ASSERT_EQ(s.octrees.size(), 1u);
  const Octree& octree = s.octrees[0];
  EXPECT_EQ(octree.low, Vec3(0));
  EXPECT_EQ(octree.unit * octree.size, 4);
  ASSERT_EQ(octree.node_count, 5u);
  const auto center = [&](uint32_t node) {
    const auto& c = s.octree_nodes[node].center;
    return octree.unit * Vec3(c[0], c[1], c[2]);
  };
  EXPECT_EQ(center(0), Vec3(2));
  EXPECT_EQ(s.octree_nodes[0].child, 1u);
  EXPECT_EQ(s.octree_nodes[0].sibling, kNone);
  EXPECT_EQ(center(1), Vec3(1));
  EXPECT_EQ(s.octree_nodes[1].sibling, 2u);
  EXPECT_EQ(s.octree_nodes[1].is_divided, 1u);
  EXPECT_EQ(center(2), Vec3(3));
  EXPECT_EQ(s.octree_nodes[2].is_divided, 0u);
  EXPECT_EQ(s.octree_nodes[2].sibling, kNone);
  EXPECT_EQ(center(3), Vec3(0.5));
  EXPECT_EQ(center(4), Vec3(1.5, 0.5, 0.5));
  EXPECT_EQ(octree.unit * s.octree_nodes[4].size, 1);
}

// Glassner's names: the root is 1, a child 8 × its parent's name + its octant; by them a hash table knows
// what cells hold.
TEST(Octree, TheHashTableKnowsByNameWhatACellHolds) {
  const CompiledScene three = make_three();
  const Scene& s = three.scene;
  const Octree& octree = s.octrees[0];
  EXPECT_EQ(octree.place_count, 1000u);
  std::map<uint64_t, uint32_t> balls;
  for (uint32_t place = 0; place < octree.place_count; ++place)
    for (uint32_t i = s.octree_hash[place]; i != kNone; i = s.octree_cells[i].next) {
      const OctreeCell& cell = s.octree_cells[i];
      EXPECT_EQ(cell.name % 1000, place);
      ASSERT_EQ(cell.pointer_count, 1u);
      const PrimitivePointer p = s.primitive_pointers[cell.first_pointer];
      balls[cell.name] = s.sphere_blocks[p.place() / 8].spheres[p.place() % 8];
    }
  EXPECT_EQ(balls, (std::map<uint64_t, uint32_t>{{8 * 8 + 0, 0}, {8 * 8 + 1, 1}, {8 + 7, 2}}));
  // With pointers nodes lead to their cells themselves.
  const CompiledScene by_pointers = make_three(OctreeNext::root, OctreeData::pointers);
  EXPECT_TRUE(by_pointers.scene.octree_hash.empty());
  for (const OctreeNode& node : by_pointers.scene.octree_nodes)
    EXPECT_TRUE(node.is_divided || node.child < by_pointers.scene.octree_cells.size());
}

// Thesis 4.2.2: "finding the point the ray leaves a volume and adding a small increment which is half the
// size of the smallest volume". Cells of a known ray are 64, 65 and the empty octant 9, left at x = 1, 2
// and 4.
TEST(Octree, ARayVisitsTheCellsOnItsWayInTheirOrder) {
  for (const OctreeNext next : {OctreeNext::root, OctreeNext::walk, OctreeNext::dda})
    for (const bool is_backward : {false, true}) {
      const CompiledScene three = make_three(next);
      const auto visited = [&](double t_max) {
        const WalkCounts counts =
            count(three, {Vec3(is_backward ? 5 : -1, 0.05, 0.95), Vec3(is_backward ? -1 : 1, 0, 0), t_max});
        return std::pair(counts.cells, counts.empty_cells);
      };
      using Pair = std::pair<uint64_t, uint64_t>;
      EXPECT_EQ(visited(0.9), Pair(0, 0));
      EXPECT_EQ(visited(1.9), is_backward ? Pair(1, 1) : Pair(1, 0));
      EXPECT_EQ(visited(2.9), is_backward ? Pair(1, 1) : Pair(2, 0));
      EXPECT_EQ(visited(3.9), is_backward ? Pair(2, 1) : Pair(3, 1));
      EXPECT_EQ(visited(9), Pair(3, 1));
    }
}

// "Perpendicular to every face it lies on": through the cube's edges a ray goes from cell to cell; a DDA
// crosses one face at a time.
TEST(Octree, ThroughAnEdgeThePointMovesAcrossBothFaces) {
  const Ray ray{Vec3(-1, -1, 1.9), normalized(Vec3(1, 1, 0))};
  EXPECT_EQ(count(make_three(OctreeNext::root), ray).cells, 3u);
  EXPECT_EQ(count(make_three(OctreeNext::walk), ray).cells, 3u);
  EXPECT_EQ(count(make_three(OctreeNext::dda), ray).cells, 5u);
}

// Nodes that are looked at, apart from cells: those of the construction tree on the way to each.
TEST(Octree, NodesPassedWhileLocatingAreCounted) {
  const Ray ray{Vec3(-1, 0.05, 0.95), Vec3(1, 0, 0)};
  const WalkCounts root = count(make_three(OctreeNext::root), ray),
                   walk = count(make_three(OctreeNext::walk), ray),
                   dda = count(make_three(OctreeNext::dda), ray);
  EXPECT_EQ(root.tree_nodes, 3u + 4u + 3u);  // to 64; from the root to 65; to where the root has no child
  EXPECT_EQ(walk.tree_nodes, 3u + 3u + 4u);  // from the parent to 65; up to the root
  EXPECT_EQ(dda.tree_nodes, 3u + 3u + 3u);
  EXPECT_EQ(root.chain_steps, 2u);  // an empty octant is known without
  EXPECT_EQ(count(make_three(OctreeNext::root, OctreeData::pointers), ray).chain_steps, 0u);
}

uint64_t tree_nodes_of(const CompiledScene& compiled, double size, uint64_t& cells) {
  FrameState state(compiled.scene);
  std::mt19937 random(6);
  WalkCounts counts;
  for (int i = 0; i < 300; ++i)
    closest_hit_counted(compiled.scene, state.at(0),
                        {test::random_point(random, size), normalized(test::random_point(random, 1))},
                        counts);
  cells = counts.cells;
  return counts.tree_nodes;
}

// Shirley, Sung and Brown, 2.3.3: "it takes extra time for the tree walking algorithm to ascend the octree".
TEST(Octree, TreeWalkingIsNotAlwaysBestForItAlsoClimbs) {
  uint64_t cells_of_root = 0, cells_of_walk = 0, cells_of_dda = 0;
  // Inside a ball about the tree's middle: every step crosses a plane of the root.
  const std::string middle =
      ball(0, 0, 0, 0.2) + ball(0, 0, 0, 0.22) + ball(-1.9, -1.9, -1.9, 0.1) + ball(1.9, 1.9, 1.9, 0.1);
  const auto in_the_middle = [&](OctreeNext next, uint64_t& cells) {
    return tree_nodes_of(
        compile_octree(middle, {.max_primitives = 1, .octree_next = next, .octree_depth = 4}), 0.1, cells);
  };
  const uint64_t from_root = in_the_middle(OctreeNext::root, cells_of_root);
  EXPECT_GT(in_the_middle(OctreeNext::walk, cells_of_walk), from_root);
  EXPECT_EQ(in_the_middle(OctreeNext::dda, cells_of_dda), from_root);
  EXPECT_EQ(cells_of_walk, cells_of_root);
  EXPECT_EQ(cells_of_dda, cells_of_root);
  // Where rays cross many small cells it passes fewer nodes.
  const SceneDescription mixed = test::make_mixed_scene(4, 1, 200);
  const auto in_mixed = [&](OctreeNext next, uint64_t& cells) {
    return tree_nodes_of(
        compile(mixed, {.hierarchy = Hierarchy::adaptive, .max_primitives = 4, .octree_next = next}), 1,
        cells);
  };
  const uint64_t of_mixed = in_mixed(OctreeNext::root, cells_of_root);
  EXPECT_LT(in_mixed(OctreeNext::walk, cells_of_walk), of_mixed);
  EXPECT_LT(in_mixed(OctreeNext::dda, cells_of_dda), of_mixed);
  EXPECT_EQ(cells_of_walk, cells_of_root);
}

TEST(Octree, EverySwitchGivesTheHitsOfBruteForce) {
  const SceneDescription mixed = test::make_mixed_scene(9, 1, 80);
  for (const OctreeData data : {OctreeData::hash, OctreeData::pointers})
    for (const OctreeNext next : {OctreeNext::root, OctreeNext::walk, OctreeNext::dda})
      for (const bool has_mailbox : {false, true})
        for (const uint32_t depth : {1u, 5u, kMostOctreeDepth})
          expect_brute_force(compile(mixed, {.hierarchy = Hierarchy::adaptive,
                                             .max_primitives = 2,
                                             .octree_data = data,
                                             .octree_next = next,
                                             .octree_depth = depth,
                                             .octree_hash = 7,
                                             .has_mailbox = has_mailbox}),
                             150, 2);
}

// Rounding on the way of a ray from very far away is larger than what cells are widened by: it tests all.
TEST(Octree, ARayFromVeryFarAwayMissesNothing) {
  const SceneDescription mixed = test::make_mixed_scene(9, 1, 80);
  const CompiledScene compiled = compile(mixed, {.hierarchy = Hierarchy::adaptive, .max_primitives = 2});
  for (const double distance : {1e3, 1e6, 1e9}) expect_brute_force(compiled, 200, 1, distance);
}

TEST(Octree, OnePrimitiveIsOneCell) {
  const CompiledScene one = compile_octree(ball(1, 2, 3, 0.5), {});
  EXPECT_EQ(one.scene.octree_nodes.size(), 1u);
  EXPECT_EQ(one.scene.octree_cells[0].name, 1u);
  expect_brute_force(one, 100, 4);
}

TEST(Octree, FlatScenesAreDividedToo) {
  std::string tiles;
  for (int i = 0; i < 64; ++i)
    tiles += fmt::format(
        "  - {{polygon: {{points: [[{0}, {1}, 0.5], [{2}, {1}, 0.5], [{2}, {3}, 0.5], [{0}, {3}, 0.5]]}}}}\n",
        i % 8, i / 8, i % 8 + 1, i / 8 + 1);
  const CompiledScene flat = compile_octree(tiles, {.max_primitives = 4});
  EXPECT_GT(flat.scene.octree_cells.size(), 60u);
  expect_brute_force(flat, 500, 8);
}

/// No division parts them: it ends where lists have become long, or at the least size.
TEST(Octree, PrimitivesWithEqualCentresEndTheDivision) {
  std::string balls;
  for (int i = 0; i < 20; ++i) balls += ball(0, 0, 0, 1 + 0.01 * i);
  const CompiledScene deep = compile_octree(balls, {.max_primitives = 4, .octree_depth = kMostOctreeDepth});
  EXPECT_LE(deep.scene.primitive_pointers.size(), 20 * (kMostPointersForEach + 8) + 4096);
  expect_brute_force(deep, 200, 2);
  const CompiledScene shallow = compile_octree(balls, {.max_primitives = 4, .octree_depth = 1});
  EXPECT_EQ(shallow.scene.octree_nodes.size(), 9u);
}

// Thesis, Table 4.5: 24 bytes a node, 4 a pointer, and the hash table; a regular hierarchy 4 for each cell
// and pointer.
TEST(Octree, BytesAreThoseOfTable4_5) {
  struct Row {
    uint64_t nodes, pointers, bytes;
  };
  for (const Row& row : {Row{1327, 11345, 81228}, Row{2600, 20000, 146400}, Row{5200, 35000, 268800},
                         Row{37, 141, 5452}, Row{62, 196, 6272}, Row{114, 258, 7768}, Row{824, 8021, 55860},
                         Row{1776, 11681, 93348}, Row{3100, 20000, 158400}})
    EXPECT_EQ((OctreeStorage{row.nodes, row.pointers, 1000}.bytes()), row.bytes);
  struct RegularRow {
    uint64_t empty, full, pointers, bytes;
  };
  for (const RegularRow& row :
       {RegularRow{10820, 1347, 13836, 104012}, RegularRow{13623, 2000, 25000, 162492},
        RegularRow{16683, 3000, 50000, 278732}, RegularRow{146, 197, 269, 2448},
        RegularRow{234, 278, 350, 3448}, RegularRow{356, 373, 445, 4696},
        RegularRow{1794, 1581, 17388, 83052}, RegularRow{2456, 2457, 300000, 1219652}})
    EXPECT_EQ((GridStorage{row.empty, row.full, row.pointers}.bytes()), row.bytes);
  const CompiledScene three = make_three();
  EXPECT_EQ(storage_of(three.scene, 0).bytes(), 5u * 24 + 3 * 4 + 4000);
  const CompiledScene grid =
      compile(test::load_yaml(test::view_text() + "scene:\n" + ball(1, 1, 1, 0.5) + ball(3, 3, 3, 0.5)),
              {.hierarchy = Hierarchy::regular, .cells = 2});
  const GridStorage storage = storage_of(grid.scene, grid.scene.grids[0]);
  EXPECT_EQ(storage.full_cells, 2u);
  EXPECT_EQ(storage.empty_cells, 6u);
  EXPECT_EQ(storage.bytes(), 4u * (8 + 2));
}

TEST(Octree, DamagedOnesAreRefused) {
  const CompiledScene three = make_three();
  const auto of_octree = [&](const std::function<void(Octree&)>& damage, const char* what) {
    test::expect_refusal_at<Octree>(three, &Scene::octrees, damage, what);
  };
  of_octree([](Octree& o) { o.unit = 0; }, "a cube of no size");
  of_octree([](Octree& o) { o.low.y = NAN; }, "a cube nowhere");
  of_octree([](Octree& o) { o.size = 3; }, "a size that can't be halved");
  of_octree([](Octree& o) { o.size *= 2; }, "a root of another size");
  of_octree([](Octree& o) { o.next = OctreeNext{3}; }, "no way to the next cell");
  of_octree([](Octree& o) { o.node_count = 6; }, "more nodes than there are");
  of_octree([](Octree& o) { o.node_count = 0; }, "no root");
  of_octree([](Octree& o) { o.cell_count = 4; }, "more cells than there are");
  of_octree([](Octree& o) { o.first_place = 1; }, "a hash table that ends too late");
  of_octree([](Octree& o) { o.place_count = 0; }, "nodes that lead to no cell");
  const auto of_node = [&](size_t node, const std::function<void(OctreeNode&)>& damage, const char* what) {
    test::expect_refusal_at<OctreeNode>(three, &Scene::octree_nodes, damage, what, node);
  };
  of_node(
      0, [](OctreeNode& n) { n.child = 0; }, "a node in itself");
  of_node(
      0, [](OctreeNode& n) { n.child = 9; }, "a child that is not there");
  of_node(
      0, [](OctreeNode& n) { n.sibling = 1; }, "a root with a sibling");
  of_node(
      1, [](OctreeNode& n) { n.sibling = 1; }, "siblings in a ring");
  of_node(
      1, [](OctreeNode& n) { n.child = 2; }, "a child of two");
  of_node(
      1, [](OctreeNode& n) { n.center[1] += 2; }, "an octant elsewhere");
  of_node(
      1, [](OctreeNode& n) { n.size /= 2; }, "an octant of another size");
  of_node(
      2, [](OctreeNode& n) { n.child = 0; }, "a cell beside the hash table");
  test::expect_refusal_at<OctreeNode>(
      make_three(OctreeNext::root, OctreeData::pointers), &Scene::octree_nodes,
      [](OctreeNode& n) { n.child = 3; }, "a cell that is not there", 2);
  const auto of_cell = [&](const std::function<void(OctreeCell&)>& damage, const char* what) {
    test::expect_refusal_at<OctreeCell>(three, &Scene::octree_cells, damage, what);
  };
  of_cell([](OctreeCell& c) { c.pointer_count = 4; }, "a list that is too long");
  of_cell([](OctreeCell& c) { c.first_pointer = 9; }, "a list elsewhere");
  of_cell([](OctreeCell& c) { c.next = 0; }, "a chain in a ring");
  test::expect_refusal_at<uint32_t>(
      three, &Scene::octree_hash, [](uint32_t& cell) { cell = 3; }, "a place of no cell");
  test::expect_refusal_at<Part>(
      three, &Scene::parts, [](Part& part) { part.collection.octree = 1; }, "a part of no octree");
}

TEST(Octree, NotesSayWhatChangesNothing) {
  const SceneDescription scene =
      test::load_yaml(test::view_text() + "scene: [{sphere: {center: [0, 0, 0], radius: 1}}]\n");
  const auto has = [&](const BuildOptions& options, const std::string& words) {
    return test::notes_of(compile(scene, options)).find(words) != std::string::npos;
  };
  EXPECT_TRUE(has({.octree_next = OctreeNext::walk}, "options of octrees"));
  EXPECT_TRUE(has({.hierarchy = Hierarchy::regular, .octree_depth = 4}, "options of octrees"));
  EXPECT_TRUE(has({.has_mailbox = true}, "mailbox"));
  EXPECT_TRUE(has({.hierarchy = Hierarchy::adaptive, .octree_data = OctreeData::pointers, .octree_hash = 9},
                  "hash table"));
  EXPECT_FALSE(has({.hierarchy = Hierarchy::adaptive,
                    .max_primitives = 25,
                    .octree_data = OctreeData::pointers,
                    .octree_next = OctreeNext::dda,
                    .octree_depth = 9,
                    .has_mailbox = true},
                   "changes nothing"));
}

}  // namespace
}  // namespace rayfarm
