// Builds that are asked to stop.
#include <chrono>
#include <cstring>
#include <thread>

#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

/// A carpet of 2 × side × side triangles.
SceneDescription make_carpet(uint32_t side) {
  SceneDescription scene;
  scene.files = {"carpet"};
  scene.materials.emplace_back("default");
  scene.objects.push_back({"root", {}, {}, {}});
  MeshShape mesh;
  std::mt19937 random(1);
  for (uint32_t y = 0; y <= side; ++y)
    for (uint32_t x = 0; x <= side; ++x)
      mesh.positions.emplace_back(x, y, static_cast<float>(test::uniform(random, 0, 3)));
  for (uint32_t y = 0; y < side; ++y)
    for (uint32_t x = 0; x < side; ++x) {
      const uint32_t a = y * (side + 1) + x, b = a + side + 1;
      mesh.triangles.emplace_back(a, a + 1, b);
      mesh.triangles.emplace_back(a + 1, b + 1, b);
    }
  scene.objects[0].primitives.push_back({std::move(mesh), 0, {}});
  return scene;
}

TEST(Stop, EndsABuildWithBothRules) {
  const SceneDescription scene = make_carpet(600);
  for (const Hierarchy hierarchy : {Hierarchy::sah, Hierarchy::thesis}) {
    std::stop_source stop;
    std::thread user([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(120));
      stop.request_stop();
    });
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_THROW(compile(scene, {.hierarchy = hierarchy, .stop = stop.get_token()}), Stopped);
    user.join();
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
  }
}

TEST(Stop, ABuildThatNobodyStopsIsTheSame) {
  const SceneDescription scene = make_carpet(150);
  const CompiledScene a = compile(scene), b = compile(scene, {.stop = std::stop_source().get_token()});
  ASSERT_EQ(a.block.size, b.block.size);
  EXPECT_EQ(std::memcmp(a.block.data.get(), b.block.data.get(), a.block.size), 0);
}

}  // namespace
}  // namespace rayfarm
