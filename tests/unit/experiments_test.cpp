// What experiments make and count.
#include "common/compile/compile.h"
#include "host/experiments/net-load/ray_shares.h"
#include "host/experiments/working-sets/terrain.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

TEST(WorkingSets, TerrainHasTwoTrianglesACell) {
  const std::string path = test::write_temporary("terrain.yaml", "");
  write_terrain(path, 7);
  EXPECT_EQ(compile(load_scene(path)).scene.triangle_shading.size(), 98u);
}

// Figure 4.6: ray 1 strikes in the first volume tested, ray 2 leaves through empty space, ray 3 passes
// through full volumes without striking there. 81 spheres in a plane, seen from afar: a ray strikes one of
// them or none.
TEST(RayTypes, CountTheThreeOfFigure_4_6) {
  std::string text =
      "view: {location: [0, 0, 100], look_at: [0, 0, 0], field_of_view: 30, aspect: 1}\n"
      "lights: [{position: [0, 0, 99]}]\nscene:\n";
  for (int x = -16; x <= 16; x += 4)
    for (int y = -16; y <= 16; y += 4)
      text += fmt::format("  - {{sphere: {{center: [{}, {}, 0], radius: 1}}}}\n", x, y);
  constexpr int kSide = 90;
  const VolumeTypes types = count_volume_types(test::write_temporary("types.yaml", text), kSide, kSide);
  const auto [strike, miss, vain] = types.eye_rays;
  EXPECT_EQ(strike + miss + vain, uint64_t{kSide * kSide});
  // By geometry: rays that strike a sphere, and rays that leave the box of all spheres aside.
  uint64_t hits = 0, aside = 0;
  const double slope = 2 * std::tan(glm::radians(15.0)) / kSide;
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) {
      const Vec3 direction =
          glm::normalize(Vec3(slope * (i + 0.5 - kSide / 2), slope * (j + 0.5 - kSide / 2), -1));
      bool is_hit = false;
      for (int x = -16; x <= 16; x += 4)
        for (int y = -16; y <= 16; y += 4)
          is_hit = is_hit || glm::length(glm::cross(Vec3(x, y, -100), direction)) < 1;
      const double widest = std::max(std::abs(direction.x), std::abs(direction.y)) / -direction.z;
      hits += is_hit ? 1 : 0;
      aside += 99 * widest > 17.01 ? 1 : 0;
    }
  EXPECT_LE(strike, hits);
  EXPECT_GE(strike + vain, hits);
  EXPECT_GT(strike, 0u);
  EXPECT_GT(vain, 0u);
  EXPECT_GT(aside, 1000u);
  EXPECT_GE(miss, aside);
}

}  // namespace
}  // namespace rayfarm
