// Grids of equal cells: which cells hold what, and which a ray visits.
#include "common/hierarchy/grid.h"

#include "common/hierarchy/cells.h"
#include "common/hierarchy/traverser.h"
#include "common/hierarchy/walk_counts.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

/// A row of five balls of radius 0.5 at x = 0.5, 1.5, …, which make the grid's box
/// 5 × 1 × 1.
CompiledScene make_row(uint32_t cells) {
  std::string text = test::view_text() + "scene:\n";
  for (int i = 0; i < 5; ++i)
    text += fmt::format("  - {{sphere: {{center: [{}, 0.5, 0.5], radius: 0.5}}}}\n", i + 0.5);
  return compile(test::load_yaml(text), {.hierarchy = Hierarchy::regular, .cells = cells});
}

/// The primitives of a cell's list.
std::vector<uint32_t> list_of(const Scene& scene, uint32_t x, uint32_t y, uint32_t z) {
  const Grid& grid = scene.grids[0];
  const size_t cell = grid.first_cell + grid.index(x, y, z);
  std::vector<uint32_t> spheres;
  for (uint32_t i = scene.grid_cells[cell]; i < scene.grid_cells[cell + 1]; ++i) {
    const PrimitivePointer p = scene.primitive_pointers[i];
    EXPECT_EQ(p.kind(), PointerKind::sphere);
    spheres.push_back(scene.sphere_blocks[p.place() / 8].spheres[p.place() % 8]);
  }
  return spheres;
}

// Thesis 2.6.2: "a full cell lists the primitives with a part in it".
TEST(Grid, CellsListThePrimitivesWithAPartInThem) {
  const CompiledScene row = make_row(10);
  const Scene& scene = row.scene;
  ASSERT_EQ(scene.grids.size(), 1u);
  EXPECT_EQ(scene.grids[0].cell_count(), 1000u);
  // Cells are 0.5 × 0.1 × 0.1: the corners of a ball's box are empty, its middle is not.
  EXPECT_TRUE(list_of(scene, 0, 0, 0).empty());
  EXPECT_EQ(list_of(scene, 0, 5, 5), std::vector<uint32_t>({0}));
  EXPECT_EQ(list_of(scene, 9, 5, 5), std::vector<uint32_t>({4}));
  // Where two balls touch, both are listed on both sides.
  EXPECT_EQ(list_of(scene, 1, 5, 5), std::vector<uint32_t>({0, 1}));
  EXPECT_EQ(list_of(scene, 2, 5, 5), std::vector<uint32_t>({0, 1}));
}

TEST(Grid, ARayVisitsTheCellsOnItsWayUntilItHits) {
  const CompiledScene row = make_row(5);
  FrameState state(row.scene);
  const auto cells = [&](const Ray& ray) {
    WalkCounts counts;
    closest_hit_counted(row.scene, state.at(0), ray, counts);
    return counts.cells;
  };
  // Cells are 1 × 0.2 × 0.2.
  EXPECT_EQ(cells({Vec3(-1, 0.5, 0.5), Vec3(1, 0, 0)}), 1u);    // the first ball is met in the first cell
  EXPECT_EQ(cells({Vec3(-1, 0.05, 0.05), Vec3(1, 0, 0)}), 5u);  // none is, along an edge of the box
  EXPECT_EQ(cells({Vec3(6, 0.05, 0.05), Vec3(-1, 0, 0)}), 5u);
  EXPECT_EQ(cells({Vec3(2.05, -1, 0.05), Vec3(0, 1, 0)}), 5u);
  EXPECT_EQ(cells({Vec3(2.5, -1, 2), Vec3(0, 1, 0)}), 0u);           // past the box
  EXPECT_EQ(cells({Vec3(-1, 0.05, 0.05), Vec3(1, 0, 0), 3.5}), 3u);  // no farther than it is asked for
}

// A polygon that was cut into triangles is one primitive: one name in a list, one test.
TEST(Grid, APolygonIsOneInAList) {
  const CompiledScene compiled = compile(
      test::load_yaml(
          test::view_text() +
          "scene: [{polygon: {points: [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0.5, 1.5, 0], [0, 1, 0]]}}]\n"),
      {.hierarchy = Hierarchy::regular, .cells = 1});
  EXPECT_EQ(compiled.scene.primitive_pointers.size(), 1u);
  FrameState state(compiled.scene);
  WalkCounts counts;
  EXPECT_TRUE(
      closest_hit_counted(compiled.scene, state.at(0), {Vec3(0.5, 1.3, -1), Vec3(0, 0, 1)}, counts).is_hit());
  EXPECT_EQ(counts.primitives(), 1u);
  EXPECT_EQ(counts.polygons, 1u);
}

TEST(Grid, AsManyCellsAsAskedForOrFourForEachPrimitive) {
  EXPECT_EQ(make_row(7).scene.grids[0].cells, (std::array<uint32_t, 3>{7, 7, 7}));
  EXPECT_EQ(make_row(0).scene.grids[0].cells, (std::array<uint32_t, 3>{3, 3, 3}));  // 27 for 5
}

// Rounding on the way of a ray from very far away is larger than what cells are widened by: it tests all.
TEST(Grid, ARayFromVeryFarAwayMissesNothing) {
  const CompiledScene row = make_row(10);
  FrameState state(row.scene);
  const Vec3 origin(-1e9, 3e8, 2e8);
  for (int i = 0; i < 5; ++i) {
    const Ray ray{origin, normalized(Vec3(i + 0.5, 0.5, 0.5) - origin)};
    EXPECT_EQ(closest_hit(row.scene, state.at(0), ray).t,
              closest_hit_brute_force(row.scene, state.at(0), ray).t);
  }
}

size_t empty_cells(const std::string& shape, uint32_t cells) {
  const CompiledScene compiled = compile(test::load_yaml(test::view_text() + "scene:\n" + shape),
                                         {.hierarchy = Hierarchy::regular, .cells = cells});
  const auto ends = compiled.scene.grid_cells;
  size_t empty = 0;
  for (size_t i = 0; i + 1 < ends.size(); ++i) empty += ends[i] == ends[i + 1];
  return empty;
}

// A surface's cells are few among those of its box.
TEST(Grid, CellsInsideABallOrAQuadricAndThoseFarFromAPlaneAreEmpty) {
  // Of 16³ cells the surface of a ball, as wide as the grid, meets about 3/2 π 16² with its thickness.
  const std::string ball = "  - {sphere: {center: [0, 0, 0], radius: 1}}\n",
                    quadric = "  - {quadric: {coefficients: [1, 1, 1, 0, 0, 0, 0, 0, 0, -1]}}\n",
                    pole = "  - {polygon: {points: [[0, 0, 0], [1, 1, 1], [1.01, 1, 1], [0.01, 0, 0]]}}\n";
  const size_t of_ball = 4096 - empty_cells(ball, 16), of_quadric = 4096 - empty_cells(quadric, 16);
  EXPECT_GT(of_ball, 1000u);
  EXPECT_LT(of_ball, 1700u);
  EXPECT_GE(of_quadric, of_ball);
  EXPECT_LT(of_quadric, 1.2 * static_cast<double>(of_ball));
  EXPECT_LT(4096 - empty_cells(pole, 16), 130u);  // along the diagonal
}

// A polygon of a file with few digits stands off its plane by some; rays meet the plane, also beyond the
// corners' box.
TEST(Grid, AWarpedPolygonIsMetWhereItsPlaneIs) {
  std::string polygon = "  - {polygon: {points: [";
  for (int i = 0; i < 12; ++i)
    polygon += fmt::format("{}[{:.17g}, {}, {:.17g}]", i == 0 ? "" : ", ", std::cos(i * 0.52),
                           i % 2 ? 2e-4 : -1e-4, std::sin(i * 0.52));
  const SceneDescription scene = test::load_yaml(test::view_text() + "scene:\n" + polygon + "]}}\n");
  std::mt19937 random(3);
  for (const Hierarchy hierarchy :
       {Hierarchy::sah, Hierarchy::thesis, Hierarchy::regular, Hierarchy::adaptive, Hierarchy::object}) {
    const CompiledScene compiled = compile(scene, {.hierarchy = hierarchy, .max_primitives = 1, .cells = 9});
    ASSERT_EQ(compiled.scene.polygons.size(), 1u);
    FrameState state(compiled.scene);
    int hits = 0;
    for (int i = 0; i < 2000; ++i) {  // nearly along the plane
      Vec3 origin = 2.0 * test::random_point(random, 1), target = test::random_point(random, 1);
      origin.y *= 1e-3;
      target.y *= 2e-4;
      const Ray ray{origin, target - origin};
      const double t = closest_hit_brute_force(compiled.scene, state.at(0), ray).t;
      EXPECT_EQ(closest_hit(compiled.scene, state.at(0), ray).t, t);
      hits += std::isfinite(t);
    }
    EXPECT_GT(hits, 100);
  }
}

// Thirty-odd bodies as large as the scene, each in all of 512³ cells, are more pointers than indices tell
// apart.
TEST(Grid, MorePointersThanThereAreIndicesAreRefused) {
  EXPECT_NO_THROW(check_count(1ull << 31, "pointers", "--cells"));
  EXPECT_THROW(check_count((1ull << 31) + 1, "pointers", "--cells"), TooManyCells);
}

TEST(Grid, ABuildTellsHowFarItIsAndStopsAmongTheCellsOfOnePrimitive) {
  const SceneDescription scene = test::load_yaml(
      test::view_text() + "scene: [{polygon: {points: [[0, 0, 0], [9, 9, 9], [9, 9, 8], [0, 0, -1]]}}]\n");
  for (const Hierarchy hierarchy : {Hierarchy::regular, Hierarchy::adaptive}) {
    BuildProgress progress;
    const CompiledScene compiled = compile(
        scene, {.hierarchy = hierarchy, .max_primitives = 1, .octree_depth = 4, .progress = &progress});
    EXPECT_GT(progress.total, 0u);
    EXPECT_EQ(progress.done, progress.total);
  }
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(compile(scene, {.hierarchy = Hierarchy::regular, .cells = 100, .stop = stop.get_token()}),
               Stopped);
}

TEST(Grid, NotesSayWhatChangesNothing) {
  const SceneDescription scene =
      test::load_yaml(test::view_text() + "scene: [{sphere: {center: [0, 0, 0], radius: 1}}]\n");
  const auto has = [](const CompiledScene& compiled, const std::string& words) {
    return test::notes_of(compiled).find(words) != std::string::npos;
  };
  EXPECT_TRUE(has(compile(scene, {.cells = 9}), "number of cells"));
  EXPECT_TRUE(
      has(compile(scene, {.hierarchy = Hierarchy::regular, .max_primitives = 4}), "there are no volumes"));
  EXPECT_TRUE(
      has(compile(scene, {.hierarchy = Hierarchy::brute, .quality = BuildQuality::high}), "high build"));
  EXPECT_FALSE(has(compile(scene, {.hierarchy = Hierarchy::regular, .cells = 9}), "changes nothing"));
}

}  // namespace
}  // namespace rayfarm
