#include "common/shapes/triangulate.h"

#include <numbers>

#include "common/math/orientation.h"
#include "common/shapes/polygon.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

using Points = std::vector<Vec3>;

double cross(const Vec3& a, const Vec3& b, const Vec3& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Twice the area of a polygon in the plane z = 0, positive if it runs counter-clockwise.
double twice_area(const Points& p) {
  double sum = 0;
  for (size_t i = 1; i + 1 < p.size(); ++i) sum += cross(p[0], p[i], p[i + 1]);
  return sum;
}

/// The polygon in the plane z = 0 is covered by triangles that turn as it does, whose areas add up to its
/// own; places at random lie in one of them inside it and in none outside.
void expect_covered(const Points& points, size_t triangle_count, const std::string& what) {
  const auto triangles = triangulate(points, Vec3(0, 0, 1));
  EXPECT_EQ(triangles.size(), triangle_count) << what;
  const double whole = twice_area(points);
  double sum = 0;
  for (const auto& [a, b, c] : triangles) {
    const double area = cross(points[a], points[b], points[c]);
    EXPECT_GT(area * whole, 0) << what;
    sum += area;
  }
  EXPECT_NEAR(sum, whole, 1e-12 * std::abs(whole)) << what;
  Box box;
  for (const Vec3& p : points) box.grow(p);
  Polygon polygon{.normal = Vec3(0, 0, 1), .drop_axis = 2};
  std::mt19937 random(5);
  for (int i = 0; i < 300; ++i) {
    const Vec3 p(test::uniform(random, box.lo.x, box.hi.x), test::uniform(random, box.lo.y, box.hi.y), 0);
    int count = 0;
    for (const auto& [a, b, c] : triangles) {
      const double s = cross(points[a], points[b], p), t = cross(points[b], points[c], p),
                   u = cross(points[c], points[a], p);
      if ((s > 0 && t > 0 && u > 0) || (s < 0 && t < 0 && u < 0)) ++count;
    }
    const bool is_inside = intersect(polygon, points, p + Vec3(0, 0, 1), Vec3(0, 0, -1), 9).has_value();
    EXPECT_EQ(count, is_inside ? 1 : 0) << what;
  }
}

Points comb(int teeth) {
  Points p;
  for (int i = 0; i < teeth; ++i) {
    p.emplace_back(2 * i, 0, 0);
    p.emplace_back(2 * i + 1, 5, 0);
  }
  p.emplace_back(2 * teeth, 0, 0);
  p.emplace_back(teeth, -1, 0);
  std::reverse(p.begin(), p.end());
  return p;
}

/// A band of width .4 that winds inwards.
Points spiral(int corners, double turns) {
  Points p;
  const int half = corners / 2;
  for (int side = 0; side < 2; ++side)
    for (int k = 0; k < half; ++k) {
      const int i = side == 0 ? k : half - 1 - k;
      const double angle = 2 * std::numbers::pi * turns * i / half;
      const double r = 1 + angle / (2 * std::numbers::pi) + 0.4 * side;
      p.emplace_back(r * std::cos(angle), r * std::sin(angle), 0);
    }
  std::reverse(p.begin(), p.end());
  return p;
}

/// Random corners, joined without crossings: crossing edges are exchanged until there are none.
Points random_simple(std::mt19937& random, int corners, bool on_a_grid) {
  Points p;
  while (p.size() < static_cast<size_t>(corners)) {
    Vec3 q(test::uniform(random, 0, 10), test::uniform(random, 0, 10), 0);
    if (on_a_grid) q = glm::floor(q);
    if (std::find(p.begin(), p.end(), q) == p.end()) p.push_back(q);
  }
  const auto turn = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    return orientation({a.x, a.y}, {b.x, b.y}, {c.x, c.y});
  };
  for (bool is_changed = true; is_changed;) {
    is_changed = false;
    for (size_t i = 0; i + 1 < p.size(); ++i)
      for (size_t j = i + 2; j < p.size(); ++j) {
        const Vec3 &a = p[i], &b = p[i + 1], &c = p[j], &d = p[(j + 1) % p.size()];
        if (turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0) {
          std::reverse(p.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                       p.begin() + static_cast<std::ptrdiff_t>(j) + 1);
          is_changed = true;
        }
      }
  }
  return p;
}

TEST(Orientation, IsExactWhereRoundingIsNot) {
  // Shewchuk's example: the third point is moved by single bits about the line through the others.
  const Vec2 a(12, 12), b(24, 24);
  const double step = std::ldexp(1.0, -53);
  for (int i = 0; i < 64; ++i)
    for (int j = 0; j < 64; ++j) {
      const Vec2 c(0.5 + i * step, 0.5 + j * step);
      EXPECT_EQ(orientation(a, b, c), c.y > c.x ? 1 : c.y < c.x ? -1 : 0);
      EXPECT_EQ(orientation(c, a, b), orientation(a, b, c));
      EXPECT_EQ(orientation(b, a, c), -orientation(a, b, c));
    }
}

TEST(Triangulate, ConvexConcaveAndWoundEitherWay) {
  const Points square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  expect_covered(square, 2, "square");
  const Points arrow{{0, 0, 0}, {2, 2, 0}, {0, 1, 0}, {-2, 2, 0}};
  expect_covered(arrow, 2, "arrow");
  expect_covered({arrow.rbegin(), arrow.rend()}, 2, "arrow, clockwise");
  expect_covered(comb(20), 40, "comb");
  expect_covered(spiral(1000, 12), 998, "spiral");
}

TEST(Triangulate, CornersOnAnEdgeAreKept) {
  const Points square{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0}, {0, 1.5, 0}};
  expect_covered(square, 5, "square with corners on its edges");
  for (const auto& triangle : triangulate(square, Vec3(0, 0, 1)))
    for (size_t k = 0; k < 3; ++k)
      for (uint32_t i = 0; i < square.size(); ++i) {
        if (std::find(triangle.begin(), triangle.end(), i) != triangle.end()) continue;
        const Vec3 &a = square[triangle[k]], &b = square[triangle[(k + 1) % 3]], &p = square[i];
        EXPECT_FALSE(cross(a, b, p) == 0 && glm::dot(p - a, p - b) < 0) << "an edge passes over a corner";
      }
}

TEST(Triangulate, HolesJoinedByBridges) {
  const Points framed{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {0, 0, 0},
                      {1, 1, 0}, {1, 3, 0}, {3, 3, 0}, {3, 1, 0}, {1, 1, 0}};
  expect_covered(framed, 8, "a frame");
  // Two holes on one bridge each, one of which passes along the other's corner.
  const Points two{{0, 0, 0}, {9, 0, 0}, {9, 4, 0}, {0, 4, 0}, {0, 0, 0}, {1, 1, 0}, {1, 3, 0}, {3, 3, 0},
                   {3, 1, 0}, {5, 1, 0}, {5, 3, 0}, {7, 3, 0}, {7, 1, 0}, {5, 1, 0}, {3, 1, 0}, {1, 1, 0}};
  expect_covered(two, 14, "two holes");
}

TEST(Triangulate, DuplicatesAndSpikes) {
  expect_covered({{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 0}, {1, 1, 0}, {0, 1, 0}}, 2, "twice");
  expect_covered({{0, 0, 0}, {1, 0, 0}, {1, 3, 0}, {1, 1, 0}, {0, 1, 0}}, 2, "a spike along an edge");
  expect_covered({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, 2, 0}, {4, 4, 0}, {0, 4, 0}}, 4, "a cut inwards");
  const Vec3 up(0, 0, 1);
  EXPECT_TRUE(triangulate(Points{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {5, 0, 0}}, up).empty());
  EXPECT_TRUE(triangulate(Points(9, Vec3(1, 2, 3)), up).empty());
  EXPECT_TRUE(triangulate(Points{{0, 0, 0}, {1, 0, 0}}, up).empty());
  EXPECT_TRUE(triangulate(Points{}, up).empty());
}

TEST(Triangulate, RandomPolygons) {
  std::mt19937 random(7);
  for (int i = 0; i < 60; ++i) {
    const int corners = 4 + i;
    expect_covered(random_simple(random, corners, false), static_cast<size_t>(corners) - 2, "random");
  }
}

TEST(Triangulate, RandomPolygonsThatTouchThemselves) {
  // On a grid corners meet edges and edges each other. What neither crosses nor runs along itself is covered.
  std::mt19937 random(8);
  int count = 0;
  for (int i = 0; i < 200; ++i) {
    const Points p = random_simple(random, 8 + i % 20, true);
    const auto triangles = triangulate(p, Vec3(0, 0, 1));
    EXPECT_LE(triangles.size(), p.size() - 2);
    double sum = 0;
    for (const auto& [a, b, c] : triangles) sum += std::abs(cross(p[a], p[b], p[c]));
    if (crosses_itself(p, Vec3(0, 0, 1)) || sum != std::abs(twice_area(p))) continue;
    expect_covered(p, triangles.size(), "on a grid");
    ++count;
  }
  EXPECT_GT(count, 20);
}

TEST(Triangulate, InAnyPlaneFarFromTheOrigin) {
  const Vec3 x = normalized(Vec3(1, 2, -0.5)), y = normalized(glm::cross(Vec3(0.3, -1, 2), x));
  Points flat = comb(30), p;
  for (const Vec3& q : flat) p.push_back(Vec3(1e6, -3e6, 2e6) + q.x * x + q.y * y);
  const Vec3 normal = newell_normal(p);
  const auto triangles = triangulate(p, normal);
  EXPECT_EQ(triangles.size(), p.size() - 2);
  double sum = 0;
  for (const auto& [a, b, c] : triangles) sum += glm::dot(newell_normal(Points{p[a], p[b], p[c]}), normal);
  EXPECT_NEAR(sum / glm::dot(normal, normal), 1, 1e-9);
}

TEST(Triangulate, EndsWhateverItIsGiven) {
  std::mt19937 random(9);
  for (int i = 0; i < 200; ++i) {
    Points p;
    for (int k = 0; k < 3 + i; ++k) p.push_back(glm::floor(test::random_point(random, i % 7 + 1)));
    EXPECT_LE(triangulate(p, test::random_point(random, 1)).size(), p.size() - 2);
  }
  Points round;
  for (int i = 0; i < 100'000; ++i)
    round.emplace_back(std::cos(2e-5 * std::numbers::pi * i), std::sin(2e-5 * std::numbers::pi * i), 0);
  EXPECT_EQ(triangulate(round, Vec3(0, 0, 1)).size(), round.size() - 2);
}

TEST(Triangulate, CrossingsAreTold) {
  const Vec3 up(0, 0, 1);
  EXPECT_FALSE(crosses_itself(comb(9), up));
  EXPECT_FALSE(crosses_itself(Points{{0, 0, 0},
                                     {4, 0, 0},
                                     {4, 4, 0},
                                     {0, 4, 0},
                                     {0, 0, 0},
                                     {1, 1, 0},
                                     {1, 3, 0},
                                     {3, 3, 0},
                                     {3, 1, 0},
                                     {1, 1, 0}},
                              up));
  EXPECT_TRUE(crosses_itself(Points{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}, up));
  Points star;
  for (int i = 0; i < 5; ++i)
    star.emplace_back(std::cos(0.8 * std::numbers::pi * i), std::sin(0.8 * std::numbers::pi * i), 0);
  EXPECT_TRUE(crosses_itself(star, up));
  EXPECT_TRUE(crosses_itself(Points{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, up));
}

TEST(CutFace, ConvexFacesPlanarOrNotStayFansFromTheirFirstCorners) {
  using Triangles = std::vector<std::array<uint32_t, 3>>;
  Triangles triangles;
  cut_face(Points{{0, 0, 0}, {1, 0, 0.1}, {1, 1, 0}, {0.5, 1.5, 0}, {0, 1, 0.1}}, triangles);
  EXPECT_EQ(triangles, (Triangles{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
  const Points notched{{0, 2, 0}, {0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 1, 0}};
  cut_face(notched, triangles);
  EXPECT_EQ(triangles.size(), 3u);
  for (const auto& [a, b, c] : triangles) EXPECT_GT(cross(notched[a], notched[b], notched[c]), 0);
}

}  // namespace
}  // namespace rayfarm
