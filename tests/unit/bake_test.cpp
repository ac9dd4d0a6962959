// "rayfarm bake (.glb: COLOR_0 at zone corners; EXR atlas per primitive)": zones as triangles and texels, and
// the light of their corners.
#include <gtest/gtest.h>

#include <set>

#include "common/lighting/zones/zone_mesh.h"
#include "host/bake/atlas_file.h"
#include "tests/unit/solved_zones.h"

namespace rayfarm {
namespace {

double area_of(const ZoneMesh& mesh) {
  double area = 0;
  for (const auto& t : mesh.triangles)
    area += 0.5 * glm::length(glm::cross(mesh.vertices[t[1]].p - mesh.vertices[t[0]].p,
                                         mesh.vertices[t[2]].p - mesh.vertices[t[0]].p));
  return area;
}

/// Of every kind of grid, moved and mirrored.
constexpr const char* kBakedShapes = R"(
objects:
  all:
    - {polygon: {points: [[0,0,0],[2,0,0],[2,1,0],[1,1,0],[1,3,0],[0,3,0]]}}
    - {polygon: {points: [[0,0,2],[2,0,2],[2,1,2],[0,1,2]]}}
    - {polygon: {points: [[4,0,0],[5,0,1],[4,2,0]]}}
    - {sphere: {center: [0,0,5], radius: 0.5}}
    - {cone: {base: [6,0,0], apex: [6,4,0], base_radius: 2, apex_radius: 1}}
    - {quadric: {coefficients: [1,1,0,0,0,0,0,0,-0.5,0], planes: [[0,0,1,1]]}}
    - {quadric: {coefficients: [1,1,1,0,0,0,0,0,0,-1], planes: [[0.6,0,0.8,0.25]]}}
scene:
  - {use: all}
  - {use: all, transform: [{scale: [-2, 2, 2]}, {rotate: {axis: [1, 2, 3], degrees: 50}}, {translate: [30, 0, 0]}]}
)";

TEST(Bake, TrianglesHaveTheAreaOfZonesAndTheirFronts) {
  const CompiledScene compiled = compile(test::load_yaml(test::view_text() + kBakedShapes));
  const ZoneScene zones(compiled.scene, test::zone_settings(0.4, 1), 0);
  const ZoneMap& map = zones.map();
  size_t grids = 0;
  for (const ZoneGrid& grid : map.grids()) {
    if (grid.shape == ZoneShape::none) continue;
    ++grids;
    const ZoneMesh mesh = mesh_of(map, grid);
    double area = 0;
    for (uint32_t cell = 0; cell < grid.cell_count; ++cell) area += map.area(grid, cell);
    const bool is_round = grid.shape == ZoneShape::revolved;
    // Facets of 7.5° lie inside of what they stand for; and areas of round zones that planes cut are sampled.
    EXPECT_NEAR(area_of(mesh), area, (is_round ? 0.02 : 1e-9) * area) << grids;
    for (const auto& t : mesh.triangles) {
      const Vec3 a = mesh.vertices[t[0]].p, b = mesh.vertices[t[1]].p, c = mesh.vertices[t[2]].p;
      const Vec3 middle = (a + b + c) / 3.0, n = normalized(glm::cross(b - a, c - a));
      if (glm::length(glm::cross(b - a, c - a)) < 1e-9) continue;
      Hit hit;
      hit.t = 1;
      hit.instance = grid.instance;
      hit.primitive = grid.primitive;
      hit.block_lane = grid.block_lane;
      hit.u = hit.v = hit.w = 1.0 / 3;
      // Seen against the triangle's normal it is the front.
      const Surface surface = eval_surface(compiled.scene, map.pose(), {middle + n, -n}, hit);
      EXPECT_TRUE(surface.is_front) << grids;
      EXPECT_GT(glm::dot(surface.geometric_normal, n), 0.9) << grids;
    }
  }
  EXPECT_EQ(grids, 14u);
}

TEST(Bake, CornersAreWhereTheyShouldBe) {
  const CompiledScene compiled = compile(test::load_yaml(
      test::view_text() + "scene: [{polygon: {points: [[1,2,3],[5,2,3],[5,4,3],[1,4,3]]}}]\n"));
  const ZoneScene zones(compiled.scene, test::zone_settings(1, 1), 0);
  const ZoneMesh mesh = mesh_of(zones.map(), zones.map().grids()[0]);
  ASSERT_EQ(mesh.vertices.size(), 15u);
  ASSERT_EQ(mesh.triangles.size(), 16u);
  const auto middle = std::find_if(mesh.vertices.begin(), mesh.vertices.end(),
                                   [](const ZoneMesh::Vertex& v) { return v.place == Vec2(2, 1); });
  ASSERT_NE(middle, mesh.vertices.end());
  EXPECT_LT(glm::length(middle->p - Vec3(3, 3, 3)), 1e-12);
}

TEST(Bake, FurnaceHasTheSameLightAtAllCorners) {
  // zonal.md 5: closed, one E and ρ: B = E / (1 - ρ), what is emitted included.
  RenderSettings settings = test::zone_settings(1, 100'000);
  settings.zones.samples = 256;
  test::SolvedZones solved(test::view_text() +
                               "materials: {wall: {luminaire: {color: 0.5, emission: [1, 2, 0]}}}\nscene:\n" +
                               room("wall"),
                           settings);
  const BakedLight light(solved.zones, std::span(&solved.solution, 1));
  for (const ZoneGrid& grid : solved.zones.map().grids()) {
    EXPECT_TRUE(light.is_lit(grid, 0));
    EXPECT_FALSE(light.is_lit(grid, 1));
    for (const ZoneMesh::Vertex& vertex : mesh_of(solved.zones.map(), grid).vertices) {
      const Color c = light.at(grid, vertex.place, 0);
      EXPECT_NEAR(c.x, 2, 0.05);
      EXPECT_NEAR(c.y, 4, 0.1);
      EXPECT_EQ(c.z, 0);
      EXPECT_EQ(light.at(grid, vertex.place, 1), Color(0));
    }
  }
}

TEST(Bake, EachZoneHasItsTexel) {
  const CompiledScene compiled = compile(test::load_yaml(test::view_text() + kBakedShapes));
  const ZoneScene zones(compiled.scene, test::zone_settings(0.4, 1), 0);
  const ZoneMap& map = zones.map();
  const AtlasLayout layout = lay_out_atlas(map);
  ASSERT_EQ(layout.rectangles.size(), 14u);
  std::set<std::pair<uint32_t, uint32_t>> taken;
  size_t texels = 0;
  for (const AtlasRectangle& r : layout.rectangles) {
    const ZoneGrid& grid = map.grids()[r.grid];
    EXPECT_EQ(uint64_t{r.columns} * r.rows, grid.cell_count);
    for (uint32_t cell = 0; cell < grid.cell_count; ++cell)
      for (uint32_t side = 0; side < 2; ++side) {
        const auto [column, row] = texel_of(map, grid, cell);
        ASSERT_LT(column, r.columns);
        ASSERT_LT(row, r.rows);
        EXPECT_LT(r.x + side * r.columns + column, layout.width);
        EXPECT_LT(r.y + row, layout.height);
        taken.emplace(r.x + side * r.columns + column, r.y + row);
        ++texels;
      }
  }
  EXPECT_EQ(taken.size(), texels);
}

}  // namespace
}  // namespace rayfarm
