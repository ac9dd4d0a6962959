// What experiments make and count: the thesis's images (Table 4.3), and Figure 4.6's types of rays.
#include <map>

#include "common/compile/compile.h"
#include "host/experiments/images/images.h"
#include "host/experiments/net-load/ray_shares.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

std::map<std::string, size_t> polygons_by_object(const SceneDescription& scene) {
  std::map<std::string, size_t> counts;
  for (const ObjectDescription& object : scene.objects)
    if (!object.primitives.empty()) counts[object.name] += object.primitives.size();
  return counts;
}

TEST(ThesisImages, BeachHouseHasTheObjectsOfTable_4_3) {
  const std::string path = test::write_temporary("beach_house.yaml", "");
  write_beach_house(path);
  const SceneDescription scene = load_scene(path);
  const std::map<std::string, size_t> table{
      {"room", 14},   {"sky", 1},    {"grass", 1},        {"centre table", 70}, {"dish", 360},
      {"sand", 2},    {"water", 3},  {"left table", 180}, {"right table", 180}, {"vase", 80},
      {"glass", 360}, {"bowl", 260}, {"frames", 80},      {"title", 67}};
  EXPECT_EQ(polygons_by_object(scene), table);  // 14 objects, 1,658 polygons
  EXPECT_NO_THROW(compile(scene));
}

TEST(ThesisImages, PlantHasTheObjectsOfTable_4_3) {
  const std::string path = test::write_temporary("plant.yaml", "");
  write_plant(path);
  const SceneDescription scene = load_scene(path);
  std::map<std::string, size_t> table{{"pot", 280}, {"dirt", 36}, {"stem", 36}, {"corner", 4}};
  for (int leaf = 1; leaf <= 8; ++leaf) table[fmt::format("leaf {}", leaf)] = 294;
  EXPECT_EQ(polygons_by_object(scene), table);  // 12 objects, 2,708 polygons
  EXPECT_NO_THROW(compile(scene));
}

TEST(ThesisImages, TerrainHasTwoTrianglesACell) {
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
