// Least balls about points (Welzl, "Smallest enclosing disks (balls and ellipsoids)", 1991). Points of a
// plane have theirs in the plane, so this is also the least circle.
#include <cmath>

#include "common/hierarchy/bounding_volumes.h"

namespace rayfarm {
namespace {

double squared(const Vec3& v) {
  return glm::dot(v, v);
}

/// The smallest ball with all of up to four points on it; none if there is no such ball.
std::optional<Ball> ball_through(std::span<const Vec3> points) {
  if (points.empty()) return Ball{Vec3(0), -1};
  const size_t n = points.size() - 1;
  // The centre is points[0] + Σ x_i q_i with 2 q_i · Σ x_j q_j = q_i².
  std::array<Vec3, 3> q{};
  std::array<std::array<double, 4>, 3> m{};
  for (size_t i = 0; i < n; ++i) q[i] = points[i + 1] - points[0];
  for (size_t i = 0; i < n; ++i) {
    for (size_t j = 0; j < n; ++j) m[i][j] = 2 * glm::dot(q[i], q[j]);
    m[i][3] = squared(q[i]);
  }
  for (size_t i = 0; i < n; ++i) {  // Gauss and Jordan's elimination
    size_t pivot = i;
    for (size_t row = i + 1; row < n; ++row)
      if (std::abs(m[row][i]) > std::abs(m[pivot][i])) pivot = row;
    std::swap(m[i], m[pivot]);
    if (!(std::abs(m[i][i]) > 1e-12 * squared(q[i]))) return std::nullopt;
    for (size_t row = 0; row < n; ++row) {
      if (row == i) continue;
      const double f = m[row][i] / m[i][i];
      for (size_t column = i; column < 4; ++column) m[row][column] -= f * m[i][column];
    }
  }
  Vec3 to_center(0);
  for (size_t i = 0; i < n; ++i) to_center += m[i][3] / m[i][i] * q[i];
  return Ball{points[0] + to_center, glm::length(to_center)};
}

bool holds(const Ball& ball, const Vec3& p) {
  return ball.radius >= 0 && squared(p - ball.center) <= ball.radius * ball.radius * (1 + 1e-12);
}

/// Of the first `count` points, with the first `on` of `surface` on it.
Ball welzl(std::span<Vec3> points, size_t count, std::array<Vec3, 4>& surface, size_t on) {
  const std::optional<Ball> through = ball_through(std::span(surface).first(on));
  if (!through) return {surface[0], -1};
  Ball ball = *through;
  if (on == 4) return ball;
  for (size_t i = 0; i < count; ++i) {
    if (holds(ball, points[i])) continue;
    surface[on] = points[i];
    const Ball larger = welzl(points, i, surface, on + 1);
    if (larger.radius >= 0) ball = larger;
    std::rotate(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(i),
                points.begin() + static_cast<std::ptrdiff_t>(i) + 1);  // those that matter come first
  }
  return ball;
}

/// Points on the surface of what a FitPoint stands for.
template <typename Visit>
void for_each_end(const FitPoint& f, Visit visit) {
  if (f.radius == 0) return visit(f.p);
  const double k = f.radius / std::sqrt(3.0);
  for (const double x : {-k, k})
    for (const double y : {-k, k})
      for (const double z : {-k, k}) visit(f.p + Vec3(x, y, z));
  for (int axis = 0; axis < 3; ++axis)
    for (const double r : {-f.radius, f.radius}) {
      Vec3 p = f.p;
      p[axis] += r;
      visit(p);
    }
}

}  // namespace

Ball least_ball(std::span<const FitPoint> points) {
  constexpr int kMostRounds = 1000;
  // Few points decide: of a growing number of them the ball is found, and the farthest outside joins them.
  std::vector<Vec3> few;
  for_each_end(points[0], [&](const Vec3& p) { few.push_back(p); });
  Ball ball;
  for (int round = 0; round < kMostRounds; ++round) {
    std::array<Vec3, 4> surface;
    ball = welzl(few, few.size(), surface, 0);
    double most = ball.radius * ball.radius * (1 + 1e-10);
    std::optional<Vec3> farthest;
    for (const FitPoint& f : points)
      for_each_end(f, [&](const Vec3& p) {
        if (squared(p - ball.center) <= most) return;
        most = squared(p - ball.center);
        farthest = p;
      });
    if (!farthest || std::find(few.begin(), few.end(), *farthest) != few.end()) break;
    few.push_back(*farthest);
  }
  ball.radius = 0;
  for (const FitPoint& f : points)
    ball.radius = std::max(ball.radius, glm::length(f.p - ball.center) + f.radius);
  return ball;
}

}  // namespace rayfarm
