#include "tests/polygon_tests.h"

#include <numbers>

#include "tests/unit/test_scene.h"

namespace rayfarm::test {
namespace {

/// A convex polygon in a plane at random: angles at random about a circle that is then squeezed and tilted.
std::vector<Vec3> convex_polygon(std::mt19937& random, size_t n) {
  std::vector<double> angles;
  for (size_t i = 0; i < n; ++i)  // apart, so that none is without area
    angles.push_back(2 * std::numbers::pi * (static_cast<double>(i) + uniform(random, 0, 0.7)) /
                     static_cast<double>(n));
  const Vec3 center = random_point(random, 10), u = random_point(random, 3);
  const Vec3 v = glm::cross(u, random_point(random, 1));
  std::vector<Vec3> points;
  for (const double angle : angles) points.push_back(center + std::cos(angle) * u + std::sin(angle) * v);
  return points;
}

/// In the polygon's plane, near it; and how far off its edges, as a part of its size.
Vec3 point_in_plane(std::mt19937& random, std::span<const Vec3> points) {
  Vec3 center(0);
  for (const Vec3& p : points) center += p / static_cast<double>(points.size());
  const Vec3 u = points[1] - points[0];
  const Vec3 v = points[points.size() - 1] - points[0];
  return center + uniform(random, -2, 2) * u + uniform(random, -2, 2) * v;
}
bool is_off_the_edges(std::span<const Vec3> points, const Vec3& p) {
  for (size_t i = 0; i < points.size(); ++i) {
    const Vec3 edge = points[(i + 1) % points.size()] - points[i];
    if (glm::length(glm::cross(edge, p - points[i])) < 1e-6 * glm::dot(edge, edge)) return false;
  }
  return true;
}

TEST(PolygonTests, AllFourOfTheThesisAgreeOffTheEdges) {
  // Thesis 2.3.3: counting edges along a ray, planes at the edges, translation to the origin, and, for
  // quadrilaterals, Ullner's parameters; and so does the one that traces pictures.
  std::mt19937 random(21);
  size_t inside = 0, all = 0;
  for (int i = 0; i < 3000; ++i) {
    const size_t n = i % 3 == 0 ? 4 : 3 + random() % 10;
    const std::vector<Vec3> points = convex_polygon(random, n);
    const Vec3 normal = normalized(newell_normal(points));
    const Polygon polygon{.normal = normal,
                          .distance = glm::dot(normal, points[0]),
                          .point_count = static_cast<uint32_t>(n),
                          .drop_axis = largest_axis(normal)};
    for (int k = 0; k < 20; ++k) {
      const Vec3 p = point_in_plane(random, points);
      if (!is_off_the_edges(points, p)) continue;
      const bool expected = EdgeCounting<double>(points).is_inside(p);
      EXPECT_EQ(EdgePlanes<double>(points).is_inside(p), expected) << n;
      EXPECT_EQ(Translation<double>(points).is_inside(p), expected) << n;
      EXPECT_EQ(intersect(polygon, points, p + normal, -normal, 2).has_value(), expected) << n;
      if (n == 4) {
        EXPECT_EQ(Parametric<double>(points).is_inside(p), expected);
      }
      ++all;
      inside += expected;
    }
  }
  EXPECT_GT(inside, all / 20);
  EXPECT_LT(inside, all * 19 / 20);
}

TEST(PolygonTests, CountingAndTranslationAgreeOnConcavePolygons) {
  std::mt19937 random(22);
  for (int i = 0; i < 300; ++i) {
    std::vector<Vec3> star = convex_polygon(random, 10);
    Vec3 center(0);
    for (const Vec3& p : star) center += 0.1 * p;
    for (size_t k = 0; k < 10; k += 2) star[k] = center + 0.3 * (star[k] - center);
    for (int k = 0; k < 20; ++k) {
      const Vec3 p = center + (1.5 * uniform(random, 0, 1)) * (star[1 + 2 * (random() % 5)] - center) +
                     0.3 * uniform(random, -1, 1) * (star[2] - center);
      if (!is_off_the_edges(star, p)) continue;
      EXPECT_EQ(EdgeCounting<double>(star).is_inside(p), Translation<double>(star).is_inside(p));
    }
  }
}

TEST(PolygonTests, ParametersTakeMoreOperationsAndARoot) {
  // "Numerous operations including a square root" (2.3.3); the edge tests take none, and fewer of the rest.
  const std::vector<Vec3> quad{{0, 0, 0}, {2, 0, 1}, {2.2, 2, 2.1}, {-0.1, 1.5, 0.7}};
  const Vec3 middle = 0.25 * (quad[0] + quad[1] + quad[2] + quad[3]);
  const auto operations = [&](const auto& test) {
    Counted::operations = {};
    EXPECT_TRUE(test.is_inside(middle));
    return Counted::operations;
  };
  const auto parametric = operations(Parametric<Counted>(quad));
  EXPECT_EQ(parametric.roots, 1);
  for (const auto& other : {operations(EdgeCounting<Counted>(quad)), operations(EdgePlanes<Counted>(quad)),
                            operations(Translation<Counted>(quad))}) {
    EXPECT_EQ(other.roots, 0);
    EXPECT_LT(other.all(), parametric.all());
  }
}

}  // namespace
}  // namespace rayfarm::test
