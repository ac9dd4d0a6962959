// Bounding volumes: how they fit, what is chosen, and what rays meet.
#include "common/hierarchy/bounding_volumes.h"

#include <cmath>
#include <numbers>

#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

constexpr std::array kKinds{VolumeKind::sphere, VolumeKind::box, VolumeKind::cylinder, VolumeKind::slabs};

std::vector<FitPoint> points_of_box(const Vec3& lo, const Vec3& hi) {
  std::vector<FitPoint> points;
  for (int i = 0; i < 8; ++i)
    points.push_back({{i & 1 ? lo.x : hi.x, i & 2 ? lo.y : hi.y, i & 4 ? lo.z : hi.z}, 0});
  return points;
}

/// Rings of twelve about z at ±half_height, as a pencil's.
std::vector<FitPoint> points_of_prism(double radius, double half_height) {
  std::vector<FitPoint> points;
  for (int i = 0; i < 12; ++i) {
    const double angle = i * std::numbers::pi / 6;
    for (const double z : {-half_height, half_height})
      points.push_back({{radius * std::cos(angle), radius * std::sin(angle), z}, 0});
  }
  return points;
}

std::vector<FitPoint> turned(std::vector<FitPoint> points) {
  const double c = std::cos(0.7), s = std::sin(0.7);
  for (auto& [p, radius] : points) {
    p = {c * p.x - s * p.y, s * p.x + c * p.y, p.z};
    p = {p.x, c * p.y - s * p.z, s * p.y + c * p.z};
    p += Vec3(3, -2, 5);
  }
  return points;
}

std::vector<FitPoint> random_points(std::mt19937& random, size_t count, double largest_radius) {
  std::vector<FitPoint> points;
  for (size_t i = 0; i < count; ++i)
    points.push_back(
        {test::random_point(random, 1) * Vec3(1, 2, 0.4), test::uniform(random, 0, largest_radius)});
  return points;
}

/// The circumscribed ball of points in whose hull's span it lies, by the equations of equal distance.
std::optional<Ball> ball_through(const std::vector<Vec3>& p) {
  const size_t n = p.size() - 1;
  if (n == 1) return Ball{0.5 * (p[0] + p[1]), 0.5 * glm::length(p[1] - p[0])};
  const Vec3 a = p[1] - p[0], b = p[2] - p[0];
  const Vec3 normal = glm::cross(a, b);
  const Vec3 c = n == 3 ? p[3] - p[0] : normal;
  const double last = n == 3 ? 0.5 * glm::dot(c, c) : 0;
  const double det = glm::dot(glm::cross(a, b), c);
  if (std::abs(det) < 1e-12) return std::nullopt;
  const Vec3 center = (0.5 * glm::dot(a, a) * glm::cross(b, c) + 0.5 * glm::dot(b, b) * glm::cross(c, a) +
                       last * glm::cross(a, b)) /
                      det;
  return Ball{p[0] + center, glm::length(center)};
}

TEST(LeastBall, OfKnownSets) {
  const Ball cube = least_ball(points_of_box(Vec3(-1), Vec3(1)));
  EXPECT_NEAR(cube.radius, std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(glm::length(cube.center), 0, 1e-12);
  const std::vector<FitPoint> obtuse{{{-2, 0, 0}, 0}, {{2, 0, 0}, 0}, {{0, 0.5, 0}, 0}};
  EXPECT_NEAR(least_ball(obtuse).radius, 2, 1e-12) << "two of its points decide";
  const std::vector<FitPoint> triangle{{{0, 0, 7}, 0}, {{1, 0, 7}, 0}, {{0.5, std::sqrt(0.75), 7}, 0}};
  EXPECT_NEAR(least_ball(triangle).radius, 1 / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(least_ball(triangle).center.z, 7, 1e-12) << "a circle, in the points' plane";
  const std::vector<FitPoint> balls{{{-2, 0, 0}, 1}, {{2, 0, 0}, 1}};
  EXPECT_NEAR(least_ball(balls).radius, 3, 1e-12);
  EXPECT_EQ(least_ball(std::vector<FitPoint>(3, {Vec3(4, 5, 6), 0})).radius, 0);
  EXPECT_NEAR(least_ball(points_of_prism(3, 0)).radius, 3, 1e-12) << "many points on one circle";
}

TEST(LeastBall, NoBallThroughTwoThreeOrFourOfThePointsIsSmallerAndHoldsAll) {
  std::mt19937 random(1);
  for (int set = 0; set < 30; ++set) {
    const std::vector<FitPoint> points = random_points(random, 10, 0);
    double least = std::numeric_limits<double>::infinity();
    for (uint32_t bits = 0; bits < 1u << points.size(); ++bits) {
      if (std::popcount(bits) < 2 || std::popcount(bits) > 4) continue;
      std::vector<Vec3> some;
      for (size_t i = 0; i < points.size(); ++i)
        if (bits >> i & 1) some.push_back(points[i].p);
      const std::optional<Ball> ball = ball_through(some);
      if (ball && std::all_of(points.begin(), points.end(), [&](const FitPoint& f) {
            return glm::length(f.p - ball->center) <= ball->radius * (1 + 1e-9);
          }))
        least = std::min(least, ball->radius);
    }
    EXPECT_NEAR(least_ball(points).radius, least, 1e-9 * least);
  }
}

// Weghorst, Hooper and Greenberg, 2: "a set of three-dimensional points which surrounds the item".
TEST(BoundingVolumes, HoldAllPoints) {
  std::mt19937 random(2);
  for (int set = 0; set < 50; ++set) {
    const std::vector<FitPoint> points = turned(random_points(random, 1 + random() % 30, set % 2 ? 0.3 : 0));
    for (const VolumeKind kind : kKinds) {
      BoundingVolume v = fit_volume(kind, points);
      widen(v, 1e-8);
      for (const FitPoint& f : points) {
        const Vec3 at = f.p + f.radius * normalized(test::random_point(random, 1));
        for (int i = 0; i < 20; ++i) {
          Vec3 direction = test::random_point(random, 1);
          if (i < 6) direction = Vec3(i % 3 == 0, i % 3 == 1, i % 3 == 2) * (i < 3 ? 1.0 : -1.0);
          const double back = test::uniform(random, 0, 20);
          const auto entry = entry_into(v, at - back * direction, direction);
          ASSERT_TRUE(entry) << static_cast<int>(kind);
          ASSERT_LE(*entry, back + 1e-9) << static_cast<int>(kind);
          ASSERT_EQ(entry_into(v, at, direction), 0.0) << "it begins inside";
        }
      }
    }
  }
}

TEST(BoundingVolumes, FitKnownShapesExactly) {
  const auto prism = turned(points_of_prism(0.5, 4));
  const BoundingVolume cylinder = fit_volume(VolumeKind::cylinder, prism);
  EXPECT_NEAR(cylinder.numbers[6], 0.5, 1e-9);
  EXPECT_NEAR(cylinder.numbers[7], 4, 1e-9);
  EXPECT_NEAR(volume_of(cylinder), 2 * std::numbers::pi, 1e-8);
  EXPECT_NEAR(projected_area(cylinder, Vec3(cylinder.numbers[3], cylinder.numbers[4], cylinder.numbers[5])),
              std::numbers::pi / 4, 1e-8);
  const auto room = points_of_box({-1, 0, -2}, {1, 3, 2});
  EXPECT_NEAR(volume_of(fit_volume(VolumeKind::box, room)), 24, 1e-12);
  EXPECT_NEAR(projected_area(fit_volume(VolumeKind::box, room), {0, 1, 0}), 8, 1e-12);
  EXPECT_NEAR(volume_of(fit_volume(VolumeKind::sphere, points_of_box(Vec3(-1), Vec3(1)))),
              4 * std::sqrt(3.0) * std::numbers::pi, 1e-9);
}

TEST(BoundingVolumes, RaysEnterWhereTheyShould) {
  const BoundingVolume sphere{VolumeKind::sphere, 0, {0, 0, 0, 2}},
      box{VolumeKind::box, 0, {-1, -1, -1, 1, 2, 3}},
      cylinder{VolumeKind::cylinder, 0, {0, 0, 0, 0, 0, 1, 1, 3}};
  EXPECT_EQ(entry_into(sphere, {-5, 0, 0}, {1, 0, 0}), 3.0);
  EXPECT_EQ(entry_into(sphere, {-5, 0, 0}, {2, 0, 0}), 1.5);  // of any length
  EXPECT_FALSE(entry_into(sphere, {-5, 2.1, 0}, {1, 0, 0}));
  EXPECT_FALSE(entry_into(sphere, {5, 0, 0}, {1, 0, 0})) << "behind the ray";
  EXPECT_EQ(entry_into(box, {0, 0, 10}, {0, 0, -1}), 7.0);
  EXPECT_FALSE(entry_into(box, {0, 2.5, 10}, {0, -0.0, -1}));
  EXPECT_NEAR(*entry_into(cylinder, {-5, 0, 0}, {1, 0, 0}), 4, 1e-14);
  EXPECT_NEAR(*entry_into(cylinder, {0.5, 0, 9}, {0, 0, -1}), 6, 1e-14) << "through a cap, along the axis";
  EXPECT_FALSE(entry_into(cylinder, {1.1, 0, 9}, {0, 0, -1}));
  EXPECT_FALSE(entry_into(cylinder, {-5, 0, 3.5}, {1, 0, 0})) << "beyond the caps";
  EXPECT_FALSE(entry_into(cylinder, {-5, 1.1, 0}, {1, 0, 0}));
  EXPECT_FALSE(entry_into(cylinder, {-4, 0, 6}, {1, 0, -0.5}))
      << "meets sides and caps' slab, not both at once";
  // Kay and Kajiya's slabs cut the corners off a box about a ball.
  const std::vector<FitPoint> ball{{Vec3(0), 1}};
  const BoundingVolume slabs = fit_volume(VolumeKind::slabs, ball);
  EXPECT_EQ(entry_into(slabs, {-5, 0, 0}, {1, 0, 0}), 4.0);
  EXPECT_FALSE(entry_into(slabs, {-5, 0.9, 0.9}, {1, 0, 0}));
  EXPECT_TRUE(entry_into(fit_volume(VolumeKind::box, ball), {-5, 0.9, 0.9}, {1, 0, 0}));
}

// Weghorst, Hooper and Greenberg, 2: "minimizing the product of the associated complexity factor and the
// volume", and factors that rise from sphere to cylinder.
TEST(BoundingVolumes, APencilGetsACylinderABallASphereARoomABox) {
  EXPECT_TRUE(std::is_sorted(kVolumeFactors.begin(), kVolumeFactors.begin() + 3));
  EXPECT_EQ(choose_volume(turned(points_of_prism(0.2, 3)), {}).kind, VolumeKind::cylinder);
  EXPECT_EQ(choose_volume(std::vector<FitPoint>{{Vec3(1), 2}}, {}).kind, VolumeKind::sphere);
  EXPECT_EQ(choose_volume(points_of_box({-8, 0, -5}, {8, 3, 5}), {}).kind, VolumeKind::box);
}

// Weghorst, Hooper and Greenberg, Figure 2: seen from the front a flat item's sphere has the least void area,
// seen from the side its parallelepiped.
TEST(BoundingVolumes, FromTheEyeTheVoidAreaDecides) {
  const std::vector<FitPoint> disc = points_of_prism(1, 0.1);
  EXPECT_EQ(choose_volume(disc, Vec3(0, 0, 50)).kind, VolumeKind::sphere);
  EXPECT_EQ(choose_volume(disc, Vec3(50, 0, 0)).kind, VolumeKind::box);
}

TEST(BoundingVolumes, ABoxIsKnownInAnyPosition) {
  EXPECT_TRUE(is_box(turned(points_of_box({-1, 0, -2}, {1, 3, 2}))));
  std::vector<FitPoint> bent = points_of_box({-1, 0, -2}, {1, 3, 2});
  bent[3].p.x += 0.2;
  EXPECT_FALSE(is_box(bent));
  EXPECT_FALSE(is_box(points_of_prism(1, 1)));
}

}  // namespace
}  // namespace rayfarm
