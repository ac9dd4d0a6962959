// Memory for large arrays, and loops on all cores.
#include <atomic>
#include <cstring>

#include "common/hierarchy/structurer.h"
#include "common/parallel/parallel_for.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

TEST(LargeArrays, PagesThatAreReleasedTakeNothingOfTheirNeighbours) {
  constexpr size_t kBytes = size_t{5} << 20;
  auto* const bytes = static_cast<unsigned char*>(allocate_large(kBytes));
  EXPECT_EQ(reinterpret_cast<uintptr_t>(bytes) % (size_t{2} << 20), 0u);
  std::memset(bytes, 7, kBytes);
  release_pages(bytes + 100, kBytes / 2);
  EXPECT_EQ(bytes[99], 7);
  EXPECT_EQ(bytes[100], 7) << "its page is not released whole";
  EXPECT_EQ(bytes[1 << 20], 0);
  EXPECT_EQ(bytes[100 + kBytes / 2], 7);
  bytes[1 << 20] = 1;
  EXPECT_EQ(bytes[1 << 20], 1);
  free_large(bytes);
}

TEST(LargeArrays, ASceneThatIsMovedIntoItsBlockIsTheSceneThatIsCopied) {
  SceneArrays<GrowingArray> arrays;
  arrays.header.resize(1);
  for (int i = 0; i < 2'000'000; ++i) arrays.mesh_points.emplace_back(i, 2 * i, 3 * i);  // 24 MB: two pieces
  arrays.leaf_instances = {1, 2, 3};
  const SceneBlock copied = encode_scene(view_of(arrays));
  const SceneBlock moved = encode_scene(std::move(arrays));
  ASSERT_EQ(copied.size, moved.size);
  EXPECT_EQ(std::memcmp(copied.data.get(), moved.data.get(), copied.size), 0);
}

TEST(LargeArrays, TrianglesOfMeshesAreFoundWhereTheyStand) {
  const LargeVector<glm::vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const LargeVector<glm::uvec3> first{{0, 1, 2}, {1, 2, 3}}, second{{3, 2, 1}};
  PartPrimitives part;
  const auto id = [](uint32_t i) { return make_primitive_id(PrimitiveKind::triangle, i); };
  part.begin_mesh(points, first);
  part.add_mesh_triangle(id(0), 1);  // the first of them is left out
  part.add_triangle(id(1), {points[0], points[1], points[3]});
  part.begin_mesh(points, second);
  part.add_mesh_triangle(id(2), 0);
  part.add(make_primitive_id(PrimitiveKind::sphere, 0));
  EXPECT_EQ(part.triangle(0), (TriangleVertices{points[1], points[2], points[3]}));
  EXPECT_EQ(part.triangle(1), (TriangleVertices{points[0], points[1], points[3]}));
  EXPECT_EQ(part.triangle(2), (TriangleVertices{points[3], points[2], points[1]}));
  EXPECT_TRUE(part.is_triangle(2));
  EXPECT_FALSE(part.is_triangle(3));
}

TEST(ParallelFor, EveryStepIsTakenOnceAndTheFirstThatFailsIsTold) {
  std::vector<std::atomic<int>> taken(1000);
  parallel_for(taken.size(), [&](size_t i) { ++taken[i]; });
  for (const std::atomic<int>& n : taken) EXPECT_EQ(n, 1);
  parallel_for(0, [](size_t) { FAIL(); });
  for (int round = 0; round < 100; ++round) try {
      parallel_for(1000, [](size_t i) {
        if (i >= 5) throw std::runtime_error(fmt::format("{}", i));
      });
      ADD_FAILURE();
    } catch (const std::runtime_error& e) {
      EXPECT_EQ(std::string(e.what()), "5");
    }
}

}  // namespace
}  // namespace rayfarm
