#pragma once
// Planar polygons of any number of sides, concave ones too (thesis 2.3.3), and how normals vary over them
// (2.3.5).
#include <optional>
#include <span>

#include "common/math/box.h"
#include "common/math/index.h"

namespace rayfarm {

/// How a polygon with normals at its nodes is shaded (thesis 2.3.5): by a normal that varies over it, or, by
/// Gouraud, by the light at its nodes.
enum class Smoothing : uint32_t { flat, phong, center, gouraud };

struct Polygon {
  Vec3 normal{0};  ///< unit; the front is where the corners run counter-clockwise
  double distance = 0;
  uint32_t first_point = 0;
  uint32_t point_count = 0;
  uint32_t first_normal = kNone;  ///< none: flat
  uint32_t smoothing = 0;         ///< enum Smoothing
  uint32_t material = 0;
  uint32_t drop_axis = 0;  ///< the axis along which the polygon is projected: its normal's largest component
};

/// The area-weighted normal (Newell's method; Equation 2.9), not normalised: its length is twice the area.
Vec3 newell_normal(std::span<const Vec3> points);

/// t in (0, t_max] at which the ray meets the polygon's inside (Equations 2.10 and 2.11).
std::optional<double> intersect(const Polygon& polygon, std::span<const Vec3> points, const Vec3& origin,
                                const Vec3& direction, double t_max);

/// The thesis's centre normal (Figure 2.12): linear between the average normal at the polygon's centre and
/// the normal on the edge behind `p`, which is linear along that edge. Not normalised.
Vec3 center_normal(std::span<const Vec3> points, std::span<const Vec3> normals, const Vec3& p);

/// Phong's interpolation: by mean value coordinates. Not normalised.
Vec3 phong_normal(std::span<const Vec3> points, std::span<const Vec3> normals, const Vec3& p,
                  const Vec3& plane_normal);

/// Of values at the corners, each times its weight.
template <typename T>
struct WeightedSum {
  T sum{0};
  double weight = 0;  ///< of all; not 0 anywhere in the plane of a polygon that doesn't cross itself

  T mean() const { return sum * (1 / weight); }
};

/// Mean value coordinates (Floater 2003; Hormann and Floater 2006 for concave polygons and points outside),
/// which for triangles are the barycentric ones, are linear along edges and, unlike scan lines, do not depend
/// on how the polygon is turned. `p`: in its plane.
template <typename T>
WeightedSum<T> mean_value_sum(std::span<const Vec3> points, std::span<const T> values, const Vec3& p,
                              const Vec3& plane_normal) {
  // Weight of corner i: (tan(a_{i-1}/2) + tan(a_i/2)) / |v_i - p|, with a_i the signed angle at p between
  // corners i and i+1. tan(a/2) = (|s_i||s_j| - s_i·s_j) / (signed area).
  const auto half_tangent = [](double product, double dot, double area) {
    return area == 0 ? 0 : (product - dot) / area;
  };
  const size_t n = points.size();
  const Vec3 last = points[n - 1] - p;
  Vec3 si = points[0] - p;
  double ri = glm::length(si);
  double previous =
      half_tangent(glm::length(last) * ri, glm::dot(last, si), glm::dot(plane_normal, glm::cross(last, si)));
  WeightedSum<T> result;
  for (size_t i = 0; i < n; ++i) {
    const size_t j = i + 1 < n ? i + 1 : 0;
    const Vec3 sj = points[j] - p;
    const double rj = glm::length(sj), dot = glm::dot(si, sj);
    const double area = glm::dot(plane_normal, glm::cross(si, sj));
    if (ri == 0) return {values[i], 1};
    if (area == 0 && dot < 0)
      return {(rj * values[i] + ri * values[j]) / (ri + rj), 1};  // p lies on this edge
    const double current = half_tangent(ri * rj, dot, area), weight = (previous + current) / ri;
    result.sum += weight * values[i];
    result.weight += weight;
    previous = current;
    si = sj;
    ri = rj;
  }
  return result;
}

/// The box of the polygon's part inside `cell`; empty if there is none.
Box clipped_bounds(std::span<const Vec3> points, const Box& cell);

}  // namespace rayfarm
