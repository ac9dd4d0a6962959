// What the experiment `hierarchies` makes of scenes, rays and files.
#include <gtest/gtest.h>

#include <filesystem>

#include "common/errors/input_error.h"
#include "host/experiments/hierarchies/growth.h"
#include "host/experiments/hierarchies/heat_map.h"
#include "host/experiments/hierarchies/lettering.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

// Thesis, Figure 4.6: "Ray 1 strikes an object in the first volume tested, ray 2 travels through a few empty
// volumes before striking an object or leaving the hierarchy, and ray 3 pass through empty and full volumes
// before".
TEST(RayTypes, AreThoseOfFigure46) {
  EXPECT_EQ(type_of_ray(0, 1, true), 0u);
  EXPECT_EQ(type_of_ray(3, 1, true), 1u);
  EXPECT_EQ(type_of_ray(3, 0, false), 1u);
  EXPECT_EQ(type_of_ray(0, 0, false), 1u);
  EXPECT_EQ(type_of_ray(0, 1, false), 2u);
  EXPECT_EQ(type_of_ray(0, 2, true), 2u);
  EXPECT_EQ(type_of_ray(2, 5, true), 2u);
}

double lightness(double share) {
  const std::array<std::byte, 3> c = heat_colour(share);
  return 0.30 * std::to_integer<int>(c[0]) + 0.59 * std::to_integer<int>(c[1]) +
         0.11 * std::to_integer<int>(c[2]);
}

TEST(HeatMaps, ColoursGrowLighterEvenly) {
  EXPECT_NEAR(lightness(0), 0, 1);
  EXPECT_NEAR(lightness(1), 255, 1);
  for (int i = 0; i <= 20; ++i) EXPECT_NEAR(lightness(i / 20.0), 255 * i / 20.0, 9) << i;
}

constexpr const char* kBalls =
    "view: {location: [0, 0, 10], look_at: [0, 0, 0], field_of_view: 40, aspect: 1}\n"
    "scene: [{sphere: {center: [-1.5, 0, 0], radius: 1}}, {sphere: {center: [1.5, 0, 0], radius: 1}}]\n";

TEST(HeatMaps, ShowTheTestsOfEachPixel) {
  constexpr int kSide = 12;
  const SceneDescription scene = test::load_yaml(kBalls);
  const std::vector<HeatMap> maps = measure_tests(
      scene, {{"brute", {.hierarchy = Hierarchy::brute}}, {"sah", {.max_primitives = 1}}}, kSide, kSide);
  ASSERT_EQ(maps.size(), 2u);
  for (const double tests : maps[0].tests) EXPECT_EQ(tests, 2);  // no lights: an eye ray meets both spheres
  EXPECT_EQ(maps[0].mean, 2);
  EXPECT_EQ(maps[1].tests.front(), 0);  // the corner sees none of them
  EXPECT_LT(maps[1].mean, 1.5);
  const Image image = draw_heat_maps(maps, kSide, kSide);
  EXPECT_EQ(image.pixels.size(),
            3u * static_cast<size_t>(image.width_px) * static_cast<size_t>(image.height_px));
  EXPECT_GE(image.width_px,
            width_of_letters("tests per pixel") + width_of_letters("100000"));  // the legend has room
}

// Thesis, Table 4.9: ptrace intersects "all the polygons in a leaf node", qtrace "all the quadric surfaces".
TEST(RayCounts, LeavesOfPolygonsAndOfCurvedPrimitivesAreToldApart) {
  const CompiledScene compiled =
      compile(test::load_yaml(
                  "view: {location: [0, 0, 10], look_at: [0, 0, 0], field_of_view: 40, aspect: 1}\n"
                  "scene:\n"
                  "  - {sphere: {center: [-3, 0, 0], radius: 1}}\n"
                  "  - {quadric: {coefficients: [1, 1, 1, 0, 0, 0, 0, 0, 0, -1], planes: [[0, 1, 0, 0.5]]}}\n"
                  "  - {polygon: {points: [[2, -1, 0], [4, -1, 0], [4, 1, 0], [2, 1, 0]]}}\n"),
              {.max_primitives = 1});
  FrameState state(compiled.scene);
  const Pose pose = state.at(0);
  const auto counts_at = [&](double x) {
    WalkCounts counts;
    EXPECT_TRUE(
        closest_hit_counted(compiled.scene, pose, {Vec3(x, 0.1, 10), Vec3(0, 0, -1)}, counts).is_hit());
    return counts;
  };
  for (const double x : {-3.0, 0.0}) {
    EXPECT_EQ(counts_at(x).curved_leaves, counts_at(x).leaves);
    EXPECT_GE(counts_at(x).spheres + counts_at(x).quadrics, 1u);
  }
  EXPECT_EQ(counts_at(3).curved_leaves, 0u);
  EXPECT_GE(counts_at(3).leaves, 1u);
  WalkCounts sum = counts_at(-3);
  sum += counts_at(3);
  EXPECT_EQ(sum.leaves, counts_at(-3).leaves + counts_at(3).leaves);
  EXPECT_EQ(sum.primitives(), counts_at(-3).primitives() + counts_at(3).primitives());
}

TEST(HeatMaps, LettersStayInThePicture) {
  Image image;
  image.width_px = 9;
  image.height_px = 11;
  image.pixels.resize(3 * 9 * 11, std::byte{0xff});
  write_letters(image, 0, 0, "18");
  EXPECT_EQ(image.pixels[3 * 2], std::byte{0});  // the stem of 1
  EXPECT_EQ(image.pixels[0], std::byte{0xff});
  EXPECT_EQ(image.pixels[3 * 8], std::byte{0});  // 8 is cut off at the edge
  EXPECT_EQ(width_of_letters("18"), 16);
}

TEST(Growth, GroundHasTwoTrianglesACell) {
  const CompiledScene compiled = compile(make_terrain(7));
  EXPECT_EQ(compiled.scene.triangle_shading.size(), 98u);
}

// Every hierarchy is asked the same rays and counts as many primitives as there are where it tests all.
TEST(Growth, RaysThroughTheGroundAreCountedAndTimed) {
  const SceneDescription scene = make_terrain(5);
  const PictureRays rays = record_rays(scene, 8);
  EXPECT_EQ(rays.eye.size(), 81u);
  EXPECT_FALSE(rays.shadow.empty());
  EXPECT_EQ(every_nth(rays, 10).eye.size(), 9u);
  const SceneFacts facts = look_at_scene(scene, 1);
  const HierarchyRun brute =
      run_hierarchy(scene, {.hierarchy = Hierarchy::brute}, rays, facts, {.builds = 1, .passes = 1});
  EXPECT_EQ(brute.primitives, 50u);
  EXPECT_EQ(brute.eye.counts.primitives(), 81u * 50u);
  EXPECT_EQ(brute.thesis_bytes,
            4 * 50 + 20 * static_cast<double>(brute.leaves) + 24 * static_cast<double>(brute.interior));
  const HierarchyRun objects =
      run_hierarchy(scene, {.hierarchy = Hierarchy::object}, rays, facts, {.builds = 1, .passes = 1});
  EXPECT_EQ(objects.objects, facts.object_nodes);
  EXPECT_GE(objects.volumes_per_ray(), 1);
  EXPECT_LE(objects.primitives_per_ray(), 50);
  const HierarchyRun grid = run_hierarchy(scene, {.hierarchy = Hierarchy::regular, .cells = 4}, rays, facts,
                                          {.builds = 1, .passes = 1});
  EXPECT_EQ(grid.cells, 64u);
  EXPECT_EQ(grid.cells - grid.empty, grid.full_lists);
  const KindCosts all = grid.all();
  EXPECT_EQ(all.rays, rays.size());
  EXPECT_EQ(all.types[0] + all.types[1] + all.types[2], rays.size());
  uint64_t visits = 0, tests = 0;
  for (size_t i = 0; i < all.counts.visits_by_fill.size(); ++i) {
    visits += all.counts.visits_by_fill[i];
    tests += all.counts.tests_by_fill[i];
  }
  EXPECT_EQ(visits, all.counts.cells - all.counts.empty_cells);
  EXPECT_GE(tests, all.counts.primitives());  // a shadow ray may end within a list
}

TEST(PeerTimes, AreReadRowByRowAndDamagedOnesAreRefused) {
  const std::string good =
      test::write_temporary("embree.csv", "scene,rays,rayfarm_ns,embree_ns\nImage 1,10,80.5,70\n");
  const std::vector<PeerTime> times = read_peer_times(good);
  ASSERT_EQ(times.size(), 1u);
  EXPECT_EQ(times[0].scene, "Image 1");
  EXPECT_EQ(times[0].rayfarm_ns, 80.5);
  EXPECT_EQ(times[0].peer_ns, 70);
  EXPECT_TRUE(read_peer_times(std::filesystem::path(good).parent_path() / "there is none.csv").empty());
  for (const char* row :
       {"Image 1,10,80.5", "Image 1,10,x,70", "Image 1,10,0,70", "Image 1,10,80.5,70e", "Image 1"}) {
    const std::string bad = test::write_temporary("embree.csv", fmt::format("scene,rays,a,b\n{}\n", row));
    EXPECT_THROW(read_peer_times(bad), InputError) << row;
  }
}

}  // namespace
}  // namespace rayfarm
