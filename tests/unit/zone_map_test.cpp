// Which zone a hit is in, where the points of a zone are, and how large it is.
#include <gtest/gtest.h>

#include <numbers>

#include "common/lighting/zones/zone_directions.h"
#include "common/lighting/zones/zone_scene.h"
#include "tests/unit/solved_zones.h"

namespace rayfarm {
namespace {

using std::numbers::pi;
using test::zone_settings;

/// A scene of one primitive, its zones, and the area that all of them must have.
void check_shape(const std::string& shape, double size, double area, double tolerance = 1e-6) {
  SCOPED_TRACE(shape);
  const CompiledScene compiled = compile(test::load_yaml(
      test::view_text() + "materials: {m: {lambertian: 0.5}}\nscene: [{material: m, " + shape + "}]\n"));
  const ZoneScene zones(compiled.scene, zone_settings(size, 1), 0);
  const ZoneMap& map = zones.map();
  double sum = 0;
  size_t checked = 0, astray = 0;
  for (const ZoneGrid& grid : map.grids()) {
    ASSERT_NE(grid.shape, ZoneShape::none);
    for (uint32_t cell = 0; cell < grid.cell_count; ++cell) {
      sum += map.area(grid, cell);
      if (!(map.area(grid, cell) > 0)) continue;
      EXPECT_EQ(map.grid_of_cell(grid.first_cell + cell), static_cast<uint32_t>(&grid - map.grids().data()));
      for (uint32_t side = 0; side < 2; ++side) {
        const SlotPlace place = map.place_of_slot(grid.slot(cell, side));
        EXPECT_EQ(place.cell, cell);
        EXPECT_EQ(place.side, side);
        for (uint32_t i = 0; i < 8; ++i) {
          const auto random = [&](uint32_t k) {
            const auto r = random_pair(3, 0, {static_cast<int>(cell), static_cast<int>(side), i}, k);
            return Vec2(r[0], r[1]);
          };
          const ZonePoint point = map.point(grid, cell, side, random(1000), random);
          // A ray that comes straight to the point finds the zone that it is of, on that side.
          const Vec3& n = point.surface.geometric_normal;
          const Ray ray{point.surface.p + 1e-3 * n, -n};
          const Hit hit = closest_hit(compiled.scene, zones.pose(), ray);
          if (!hit.is_hit() || std::abs(hit.t - 1e-3) > 1e-9)
            continue;  // past its rim, or something stands before it
          ++checked;
          const Surface surface = eval_surface(compiled.scene, zones.pose(), ray, hit);
          EXPECT_EQ(surface.is_front, side == 0);
          const ZoneGrid* const found = map.grid_of(hit);
          ASSERT_NE(found, nullptr);
          const InstancePose& pose = zones.pose()[hit.instance];
          const Vec3 p = pose.is_identity ? surface.p : pose.object_from_world.point(surface.p);
          if (found != &grid || map.cell_at(*found, map.place_of(*found, hit, p)) != cell) ++astray;
          EXPECT_NEAR(glm::dot(point.tangent, n), 0, 1e-12);
        }
      }
    }
  }
  EXPECT_NEAR(sum, area, tolerance * area);
  EXPECT_GT(checked, 0u);
  EXPECT_LE(static_cast<double>(astray), 0.002 * static_cast<double>(checked));  // rounding at borders
}

TEST(ZoneMap, PointsZonesAndAreasAgree) {
  check_shape("polygon: {points: [[0,0,0],[3,0,0],[3,0,2],[0,0,2]]}", 0.4, 6);
  check_shape("polygon: {points: [[0,0,0],[3,0,0],[1,2,0]]}", 0.37, 3);
  // Concave: an L.
  check_shape("polygon: {points: [[0,0,0],[3,0,0],[3,1,0],[1,1,0],[1,3,0],[0,3,0]]}", 0.29, 5);
  check_shape(
      "polygon: {points: [[0,0,0],[4,0,0],[5,1,0],[2,3,0],[0,2,0]]}, transform: [{scale: [1, 2, 1]}, "
      "{rotate: {axis: [1,1,0], degrees: 40}}]",
      0.7, 2 * 10.5);
  check_shape("sphere: {center: [1,2,3], radius: 2}", 0.8, 16 * pi);
  // An oblate spheroid, a = 2, c = 1: 2πa² (1 + (1 - e²) / e · artanh e), e² = 1 - c² / a².
  const double e = std::sqrt(0.75);
  check_shape("sphere: {center: [0,0,0], radius: 1}, transform: [{scale: [2, 1, 2]}]", 0.3,
              2 * pi * 4 * (1 + 0.25 / e * std::atanh(e)), 2e-3);
  check_shape("cylinder: {base: [0,0,0], top: [0,0,3], radius: 0.5}", 0.3, 3 * pi);
  // A cone's frustum: π (r + R) s.
  check_shape("cone: {base: [1,0,0], apex: [1,4,0], base_radius: 2, apex_radius: 1}", 0.5,
              3 * pi * std::sqrt(17.0), 1e-3);
  // z = x² + y² below 1: π/6 (5√5 - 1).
  check_shape("quadric: {coefficients: [1,1,0,0,0,0,0,0,-0.5,0], planes: [[0,0,1,1]]}", 0.2,
              pi / 6 * (5 * std::sqrt(5.0) - 1), 2e-3);
}

TEST(ZoneMap, CellsOfTrianglesAndTheirCorners) {
  TriangleCells cells{{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}, 5};
  for (uint32_t cell = 0; cell < 25; ++cell) {
    Vec3 middle(0);
    for (const uint32_t corner : cells.corners_of(cell)) middle += cells.corner_point(corner) / 3.0;
    EXPECT_EQ(cells.cell_at(Vec2(middle.x, middle.y) * 5.0), cell);
    const CellCorners about = cells.corners_at(Vec2(middle.x, middle.y) * 5.0);
    Vec3 p(0);
    for (size_t i = 0; i < 4; ++i) p += about.weight[i] * cells.corner_point(about.corner[i]);
    EXPECT_LT(glm::length(p - middle), 1e-12);
    const Vec3 inside = cells.point(cell, {0.3, 0.6});
    EXPECT_EQ(cells.cell_at(Vec2(inside.x, inside.y) * 5.0), cell);
  }
}

TEST(ZoneMap, CellsAboutAPlaceAreWeighedLinearly) {
  // What is linear over cells comes out linear; outside of the outermost middles it stays as it is. Where the
  // last column is beside the first, a turn from there leads half way into the next.
  for (const bool is_round : {false, true})
    for (const Vec2 place : {Vec2(2.3, 1.9), Vec2(0.1, 0.2), Vec2(4.9, 2.9), Vec2(-1, 7), Vec2(2.5, 1.5)}) {
      const NearCells near = cells_about(place, 5, 3, is_round);
      double x = 0, y = 0, weight = 0;
      for (size_t i = 0; i < 4; ++i) {
        ASSERT_LT(near.cell[i], 15u);
        double middle = near.cell[i] % 5 + 0.5;
        if (is_round && std::abs(middle - place.x) > 3) middle += middle < 2.5 ? 5 : -5;
        x += near.weight[i] * middle;
        y += near.weight[i] * (near.cell[i] / 5 + 0.5);
        weight += near.weight[i];
      }
      EXPECT_NEAR(weight, 1, 1e-12);
      EXPECT_NEAR(y, std::clamp(place.y, 0.5, 2.5), 1e-12);
      EXPECT_NEAR(x, is_round ? std::clamp(place.x, 0.0, 5.0) : std::clamp(place.x, 0.5, 4.5), 1e-12);
    }
}

TEST(ZoneMap, DirectionsHaveEqualProjectedSolidAngles) {
  // Cells of directions are as likely as each other under Lambert's law, and a place leads back to itself.
  constexpr uint32_t kCells = 7;
  std::vector<int> hits(kCells * kCells);
  const ZoneStore store{true, kCells};
  for (uint32_t i = 0; i < 49'000; ++i) {
    const auto r = random_pair(1, 0, {0, 0, i}, 0);
    const Vec2 place(r[0], r[1]);
    const Vec3 direction = direction_at(place);
    EXPECT_LT(glm::length(direction_place(direction) - place), 1e-7);
    const double sine = std::sqrt(r[0]), turn = 2 * pi * r[1];
    ++hits[direction_slot(
               store, direction_place({sine * std::cos(turn), sine * std::sin(turn), std::sqrt(1 - r[0])})) -
           1];
  }
  for (const int n : hits) EXPECT_NEAR(n, 1000, 130);
  EXPECT_EQ(direction_cells_for(1000), 0u);  // such a lobe is followed
  EXPECT_GT(direction_cells_for(100), direction_cells_for(10));
}

TEST(ZoneMap, RaysLeaveOnTheSideThatIsAskedFor) {
  // Corners that floats can't hold, and planes askew: no ray from a zone meets the surface that it leaves.
  for (const char* points : {"[[-0.7,2.39,-0.9],[0.7,2.39,-0.9],[0.7,2.39,0.5],[-0.7,2.39,0.5]]",
                             "[[-0.7,2.37,-0.9],[0.7,2.37,-0.9],[0.7,2.37,0.5],[-0.7,2.37,0.5]]",
                             "[[0.1,0.7,0.3],[1.3,0.9,0.3],[1.4,0.3,1.7],[0.2,0.1,1.7]]",
                             "[[10.1,7.3,5.7],[10.4,7.1,5.9],[10.7,7.7,5.1]]"})
    for (const char* transform :
         {"", ", transform: [{rotate: {axis: [1,2,3], degrees: 37}}, {scale: 1.3}]"}) {
      const CompiledScene compiled = compile(test::load_yaml(
          test::view_text() + fmt::format("materials: {{m: {{lambertian: 0.5}}}}\nscene: [{{material: m, "
                                          "polygon: {{points: {}}}{}}}]\n",
                                          points, transform)));
      const ZoneScene zones(compiled.scene, zone_settings(0.2, 1), 0);
      for (const ZoneGrid& grid : zones.map().grids())
        for (uint32_t i = 0; i < 16 * grid.cell_count; ++i) {
          const auto r = random_pair(1, 0, {0, 0, i}, 0);
          const ZonePoint point =
              zones.map().point(grid, i / 16, i % 2, Vec2(r[0], r[1]), [](uint32_t) { return Vec2(0.5); });
          if (!(zones.map().area(grid, i / 16) > 0)) continue;
          const Vec3& n = point.surface.geometric_normal;
          const Vec3 direction = normalized(n + 0.9 * point.tangent);
          EXPECT_FALSE(
              closest_hit(compiled.scene, zones.pose(), {point.surface.ray_origin(direction), direction})
                  .is_hit())
              << points;
        }
    }
}

TEST(ZoneMap, TooManyZonesAreRefused) {
  const CompiledScene compiled =
      compile(test::load_yaml(test::view_text() + "materials: {m: {lambertian: 0.5}}\nscene: [{material: m, "
                                                  "sphere: {center: [0,0,0], radius: 1000}}]\n"));
  for (const double size : {1e-12, 0.1}) {
    try {
      const ZoneScene zones(compiled.scene, zone_settings(size, 1), 0);
      FAIL() << "not refused";
    } catch (const std::runtime_error& e) {
      EXPECT_NE(std::string(e.what()).find("--zone-size"), std::string::npos) << e.what();
    }
  }
}

}  // namespace
}  // namespace rayfarm
