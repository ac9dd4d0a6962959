#include "common/math/double_double.h"
#include "common/shapes/polygon.h"
#include "common/shapes/quadric.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

TEST(Quadric, SphereMeetsARayWhereGeometrySaysSo) {
  // x² + y² + z² = 4 about (1, 2, 3), as coefficients about the world's origin.
  const Quadric q = make_quadric({1, 1, 1, 0, 0, 0, -1, -2, -3, 14 - 4}, Vec3(0));
  const auto t = intersect(q, {}, Vec3(1, 2, -10), Vec3(0, 0, 1), 1e9);
  ASSERT_TRUE(t);
  EXPECT_NEAR(*t, 11, 1e-12);  // 13 to the centre less the radius
  const auto from_inside = intersect(q, {}, Vec3(1, 2, 3), Vec3(0, 0, 1), 1e9);
  ASSERT_TRUE(from_inside);
  EXPECT_NEAR(*from_inside, 2, 1e-12);
  EXPECT_FALSE(intersect(q, {}, Vec3(1, 4.001, -10), Vec3(0, 0, 1), 1e9));
}

// A root is moved onto the surface before it is compared with the end of the search: a search as far as a hit
// finds it again.
TEST(Quadric, ThinOnesAreHitWhereTheSearchEndsAtTheHit) {
  std::array<Vec4, 2> planes;
  const Vec3 top(3, 10, 1), eye(0.05, 0.12, 0.4);
  const Quadric wire = make_cone(Vec3(0), 0.01, top, 0.01, planes);
  std::mt19937 random(5);
  int hits = 0;
  for (int i = 0; i < 5000; ++i) {
    const Vec3 target = test::uniform(random, 0, 1) * top + test::random_point(random, 0.01);
    const std::optional<double> t =
        intersect(wire, planes, eye, target - eye, std::numeric_limits<double>::infinity());
    if (!t) continue;
    ++hits;
    EXPECT_EQ(intersect(wire, planes, eye, target - eye, *t), t);
    EXPECT_EQ(intersect(wire, planes, eye, target - eye, std::nextafter(*t, 0)), std::nullopt);
  }
  EXPECT_GT(hits, 1000);
}

TEST(Quadric, BoundsOfEllipsoidConeAndCutSphere) {
  const auto ellipsoid = quadric_bounds(make_quadric({1, 0.25, 1.0 / 9, 0, 0, 0, 0, 0, 0, -1}, Vec3(0)), {});
  ASSERT_TRUE(ellipsoid);
  EXPECT_NEAR(ellipsoid->hi.x, 1, 1e-6);
  EXPECT_NEAR(ellipsoid->hi.y, 2, 1e-6);
  EXPECT_NEAR(ellipsoid->lo.z, -3, 1e-6);
  std::array<Vec4, 2> planes;
  const Quadric cone = make_cone(Vec3(0), 2, Vec3(0, 3, 0), 0, planes);
  const auto box = quadric_bounds(cone, planes);
  ASSERT_TRUE(box);
  EXPECT_NEAR(box->hi.x, 2, 1e-6);
  EXPECT_NEAR(box->hi.y, 3, 1e-6);
  EXPECT_NEAR(box->lo.y, 0, 1e-6);
  const std::vector<Vec4> upper{Vec4(0, -1, 0, 0)};  // -y <= 0
  const auto half = quadric_bounds(make_quadric({1, 1, 1, 0, 0, 0, 0, 0, 0, -1}, Vec3(0)), upper);
  ASSERT_TRUE(half);
  EXPECT_NEAR(half->lo.y, 0, 1e-6);
  EXPECT_NEAR(half->hi.y, 1, 1e-6);
}

TEST(Quadric, UnboundedAndEmptyAreTold) {
  EXPECT_FALSE(
      quadric_bounds(make_quadric({1, 1, 0, 0, 0, 0, 0, 0, 0, -1}, Vec3(0)), {}));  // endless cylinder
  EXPECT_FALSE(quadric_bounds(make_quadric({0, 0, 0, 0, 0, 0, 0, 1, 0, 0}, Vec3(0)), {}));  // a plane
  const auto nothing =
      quadric_bounds(make_quadric({1, 1, 1, 0, 0, 0, 0, 0, 0, 1}, Vec3(0)), {});  // no real points
  ASSERT_TRUE(nothing);
  EXPECT_TRUE(nothing->is_empty());
}

TEST(Quadric, BoundsHoldEveryHit) {
  // Random cut quadrics: whatever a ray finds lies inside the bounds.
  std::mt19937 random(12);
  int found = 0;
  for (int i = 0; i < 300; ++i) {
    std::array<double, 10> k;
    for (double& v : k) v = test::uniform(random, -1, 1);
    std::vector<Vec4> planes;
    for (int axis = 0; axis < 3; ++axis)
      for (const double sign : {-1.0, 1.0}) {
        Vec3 n = 0.3 * test::random_point(random, 1);
        n[axis] += sign;
        planes.emplace_back(n, test::uniform(random, 0.2, 1.5));
      }
    const Quadric q = make_quadric(k, Vec3(0));
    const auto box = quadric_bounds(q, planes);
    ASSERT_TRUE(box);
    for (int j = 0; j < 200; ++j) {
      const Vec3 origin = test::random_point(random, 3),
                 direction = normalized(test::random_point(random, 1) - 0.5 * origin);
      if (const auto t = intersect(q, planes, origin, direction, 1e9)) {
        const Vec3 p = origin + *t * direction;
        EXPECT_TRUE(glm::all(glm::greaterThanEqual(p, box->lo)) && glm::all(glm::lessThanEqual(p, box->hi)));
        ++found;
      }
    }
  }
  EXPECT_GT(found, 1000);
}

TEST(Quadric, SmallAndFarKeepsItsDigits) {
  std::array<Vec4, 2> planes;
  const Quadric cylinder = make_cone(Vec3(1000, 0, -1), 0.01, Vec3(1000, 0, 1), 0.01, planes);
  const auto t = intersect(cylinder, planes, Vec3(0, 0, 0), Vec3(1, 0, 0), 1e9);
  ASSERT_TRUE(t);
  EXPECT_NEAR(*t, 999.99, 1e-11);
}

TEST(DoubleDouble, KeepsWhatDoublesLose) {
  const double tiny = std::ldexp(1.0, -60);
  EXPECT_EQ((DoubleDouble::sum(1, tiny) + -1.0).high, tiny);
  // (1 + t)(1 - t) = 1 - t².
  EXPECT_EQ(
      (DoubleDouble::sum(1, std::ldexp(1.0, -40)) * DoubleDouble::sum(1, -std::ldexp(1.0, -40)) + -1.0).high,
      -std::ldexp(1.0, -80));
  EXPECT_EQ((DoubleDouble(3) * (1.0 / 3) + -1.0).high, std::fma(3, 1.0 / 3, -1));
}

TEST(Quadric, LongAndThinKeepsItsDigits) {
  // Whatever its clip, hits lie within half of what surfaces allow for rounding; the paraboloid x² + z² = y
  // and a cylinder, met from inside, from along them and from beside.
  std::mt19937 random(4);
  for (const double length : {8.0, 512.0, 1e4, 1e6}) {
    const std::vector<Vec4> below{Vec4(0, 1, 0, length)};
    const Quadric paraboloid = make_quadric({1, 0, 1, 0, 0, 0, 0, -0.5, 0, 0}, Vec3(0, 0.5 * length, 0));
    const Vec3 axis = normalized(Vec3(1, 2, -0.7));
    std::array<Vec4, 2> ends;
    const Quadric cylinder = make_cone(-0.5 * length * axis, 1, 0.5 * length * axis, 1, ends);
    for (const bool is_cylinder : {false, true}) {
      const Quadric& q = is_cylinder ? cylinder : paraboloid;
      double worst = 0;
      int found = 0;
      for (int i = 0; i < 20'000; ++i) {
        const double u = std::pow(10, test::uniform(random, -3, 0)), phi = test::uniform(random, 0, 6.28);
        const double wide = is_cylinder ? 1 : u * std::sqrt(length);
        const Vec3 across = normalized(glm::cross(axis, Vec3(1, 0, 0)));
        const Vec3 p = is_cylinder ? (u - 0.5) * length * axis + std::cos(phi) * across +
                                         std::sin(phi) * glm::cross(axis, across)
                                   : Vec3(wide * std::cos(phi), wide * wide, wide * std::sin(phi));
        const Vec3 from = i % 3 == 0   ? p + test::random_point(random, wide)
                          : i % 3 == 1 ? test::random_point(random, length)
                                       : 0.7 * length * (is_cylinder ? axis : Vec3(0, 2, 0)) +
                                             test::random_point(random, 1);
        const Vec3 direction = normalized(p - from);
        const auto t =
            intersect(q, is_cylinder ? std::span<const Vec4>(ends) : below, from, direction, 1e300);
        if (!t) continue;
        ++found;
        const Vec3 hit = from + *t * direction;
        const DoubleDouble x = DoubleDouble::sum(hit.x, -q.origin.x),
                           y = DoubleDouble::sum(hit.y, -q.origin.y),
                           z = DoubleDouble::sum(hit.z, -q.origin.z);
        const auto& a = q.a;
        const double value = (x * (x * a[0] + y * a[3] + z * a[4] + 2 * q.b.x) +
                              y * (x * a[3] + y * a[1] + z * a[5] + 2 * q.b.y) +
                              z * (x * a[4] + y * a[5] + z * a[2] + 2 * q.b.z) + q.c)
                                 .high;
        const double off = std::abs(value) / (2 * glm::length(q.gradient(hit)));
        worst = std::max(
            worst, off / std::max({max_magnitude(hit), max_magnitude(from), *t * max_magnitude(direction)}));
      }
      EXPECT_GT(found, 15'000);
      EXPECT_LE(worst, 0x1p-46) << (is_cylinder ? "cylinder " : "paraboloid ") << length;
    }
  }
}

Polygon make_polygon(std::span<const Vec3> points) {
  Polygon p;
  p.normal = normalized(newell_normal(points));
  p.distance = glm::dot(p.normal, points[0]);
  p.point_count = static_cast<uint32_t>(points.size());
  p.drop_axis = largest_axis(p.normal);
  return p;
}

TEST(Polygon, ConcaveInsideAndOutside) {
  const std::vector<Vec3> arrow{{0, 0, 0}, {2, 2, 0}, {0, 1, 0}, {-2, 2, 0}};
  const Polygon p = make_polygon(arrow);
  EXPECT_TRUE(intersect(p, arrow, Vec3(0, 0.5, 5), Vec3(0, 0, -1), 1e9));
  EXPECT_FALSE(intersect(p, arrow, Vec3(0, 1.5, 5), Vec3(0, 0, -1), 1e9));  // in the notch
  EXPECT_TRUE(intersect(p, arrow, Vec3(1.2, 1.5, 5), Vec3(0, 0, -1), 1e9));
}

TEST(Polygon, ASharedEdgeBelongsToExactlyOne) {
  // Two squares side by side: each point of the edge between them lies in one, so nothing leaks and nothing
  // doubles.
  const std::vector<Vec3> left{{-1, 0, 0}, {0, 0, 0}, {0, 1, 0}, {-1, 1, 0}},
      right{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  for (int i = 1; i < 100; ++i) {
    const Vec3 origin(0, i / 100.0, 1);
    const int count = (intersect(make_polygon(left), left, origin, Vec3(0, 0, -1), 9) ? 1 : 0) +
                      (intersect(make_polygon(right), right, origin, Vec3(0, 0, -1), 9) ? 1 : 0);
    EXPECT_EQ(count, 1);
  }
}

TEST(Polygon, CenterNormalAtCenterEdgeAndBetween) {
  const std::vector<Vec3> square{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  const std::vector<Vec3> normals{normalized({-1, -1, 1}), normalized({1, -1, 1}), normalized({1, 1, 1}),
                                  normalized({-1, 1, 1})};
  EXPECT_NEAR(glm::length(center_normal(square, normals, Vec3(0)) - Vec3(0, 0, 1)), 0, 1e-12);
  const Vec3 edge_middle = 0.5 * (normals[1] + normals[2]);
  EXPECT_NEAR(glm::length(center_normal(square, normals, Vec3(1, 0, 0)) - edge_middle), 0, 1e-9);
  EXPECT_NEAR(
      glm::length(center_normal(square, normals, Vec3(0.5, 0, 0)) - 0.5 * (edge_middle + Vec3(0, 0, 1))), 0,
      1e-9);
  EXPECT_NEAR(glm::length(center_normal(square, normals, Vec3(1, 1, 0)) - normals[2]), 0, 1e-6);
}

TEST(Polygon, PhongNormalIsLinearOnATriangleAndOnEdges) {
  const std::vector<Vec3> points{{0, 0, 0}, {4, 0, 0}, {0, 3, 0}}, normals{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const Vec3 weights(0.2, 0.5, 0.3);
  const Vec3 p = weights.x * points[0] + weights.y * points[1] + weights.z * points[2];
  const Vec3 n = phong_normal(points, normals, p, Vec3(0, 0, 1));
  EXPECT_NEAR(glm::length(n / (n.x + n.y + n.z) - weights), 0, 1e-12);
  const Vec3 on_edge = phong_normal(points, normals, Vec3(1, 0, 0), Vec3(0, 0, 1));
  EXPECT_NEAR(glm::length(on_edge - Vec3(0.75, 0.25, 0)), 0, 1e-12);
}

TEST(Polygon, ClippedBoundsAreTight) {
  const std::vector<Vec3> triangle{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  const Box box = clipped_bounds(triangle, {Vec3(1, 1, -1), Vec3(9, 9, 1)});
  EXPECT_NEAR(box.lo.x, 1, 1e-12);
  EXPECT_NEAR(box.hi.x, 3, 1e-12);
  EXPECT_NEAR(box.hi.y, 3, 1e-12);
  EXPECT_TRUE(clipped_bounds(triangle, {Vec3(3, 3, -1), Vec3(9, 9, 1)}).is_empty());
}

}  // namespace
}  // namespace rayfarm
