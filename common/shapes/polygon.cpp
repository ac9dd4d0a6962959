#include "common/shapes/polygon.h"

#include <cmath>
#include <vector>

namespace rayfarm {

Vec3 newell_normal(std::span<const Vec3> points) {
  // Relative to the first point, so that digits are kept far from the origin.
  Vec3 sum(0);
  for (size_t i = 1; i + 1 < points.size(); ++i)
    sum += glm::cross(points[i] - points[0], points[i + 1] - points[0]);
  return sum;
}

std::optional<double> intersect(const Polygon& polygon, std::span<const Vec3> points, const Vec3& origin,
                                const Vec3& direction, double t_max) {
  const double approach = glm::dot(polygon.normal, direction);
  if (approach == 0) return std::nullopt;
  const double t = (polygon.distance - glm::dot(polygon.normal, origin)) / approach;
  if (!(t > 0 && t <= t_max)) return std::nullopt;
  const uint32_t ua = (polygon.drop_axis + 1) % 3, va = (polygon.drop_axis + 2) % 3;
  const double u = origin[static_cast<int>(ua)] + t * direction[static_cast<int>(ua)];
  const double v = origin[static_cast<int>(va)] + t * direction[static_cast<int>(va)];
  // Count the edges that a line along +u crosses. Each edge holds its lower end but not its upper one, so
  // that a corner on the line counts once.
  bool inside = false;
  Vec3 p = points.back();
  double pu = p[static_cast<int>(ua)] - u, pv = p[static_cast<int>(va)] - v;
  for (const Vec3& q : points) {
    const double qu = q[static_cast<int>(ua)] - u, qv = q[static_cast<int>(va)] - v;
    if ((pv > 0) != (qv > 0)) {
      const double side = pu * qv - qu * pv;  // the crossing's u times (qv - pv)
      if (qv > pv ? side > 0 : side < 0) inside = !inside;
    }
    pu = qu;
    pv = qv;
  }
  return inside ? std::optional(t) : std::nullopt;
}

Vec3 center_normal(std::span<const Vec3> points, std::span<const Vec3> normals, const Vec3& p) {
  Vec3 center(0), normal_at_center(0);
  for (const Vec3& q : points) center += q;
  for (const Vec3& n : normals) normal_at_center += n;
  center /= static_cast<double>(points.size());
  normal_at_center = normalized(normal_at_center);
  const Vec3 outward = p - center;
  const double outward2 = glm::dot(outward, outward);
  if (outward2 == 0) return normal_at_center;
  // Where the line from the centre through p leaves: center + s (p - center) on an edge, smallest s >= 1.
  const Vec3 plane = newell_normal(points);
  double best = std::numeric_limits<double>::infinity();
  Vec3 edge_normal = normal_at_center;
  for (size_t i = 0; i < points.size(); ++i) {
    const size_t j = (i + 1) % points.size();
    const Vec3 edge = points[j] - points[i];
    const Vec3 across = glm::cross(plane, edge);  // in the plane, orthogonal to the edge
    const double approach = glm::dot(across, outward);
    if (approach == 0) continue;
    const double s = glm::dot(across, points[i] - center) / approach;
    const double along = glm::dot(center + s * outward - points[i], edge) / glm::dot(edge, edge);
    if (s >= 1 - 1e-9 && s < best && along >= -1e-9 && along <= 1 + 1e-9) {
      best = s;
      edge_normal = normals[i] + std::clamp(along, 0.0, 1.0) * (normals[j] - normals[i]);
    }
  }
  if (!std::isfinite(best)) return normal_at_center;
  const double f = 1 / std::max(best, 1.0);
  return normal_at_center + f * (edge_normal - normal_at_center);
}

Vec3 phong_normal(std::span<const Vec3> points, std::span<const Vec3> normals, const Vec3& p,
                  const Vec3& plane_normal) {
  return mean_value_sum(points, normals, p, plane_normal).sum;
}

Box clipped_bounds(std::span<const Vec3> points, const Box& cell) {
  // Sutherland and Hodgman's algorithm, plane by plane; a concave polygon's result may hold edges along the
  // cell's faces, which the bounds allow.
  std::vector<Vec3> current(points.begin(), points.end()), next;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const double plane = side ? cell.hi[axis] : cell.lo[axis];
      const double sign = side ? -1 : 1;
      next.clear();
      for (size_t i = 0; i < current.size(); ++i) {
        const Vec3& p = current[i];
        const Vec3& q = current[(i + 1) % current.size()];
        const double dp = sign * (p[axis] - plane), dq = sign * (q[axis] - plane);
        if (dp >= 0) next.push_back(p);
        if ((dp > 0 && dq < 0) || (dp < 0 && dq > 0)) {
          Vec3 crossing = p + (dp / (dp - dq)) * (q - p);
          crossing[axis] = plane;
          next.push_back(crossing);
        }
      }
      current.swap(next);
      if (current.empty()) return {};
    }
  Box box;
  for (const Vec3& p : current) box.grow(p);
  return box;
}

}  // namespace rayfarm
