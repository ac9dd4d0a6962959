#pragma once
// Planar polygons of any number of sides, concave ones too (thesis 2.3.3), and how normals vary over them
// (2.3.5).
#include <optional>
#include <span>

#include "common/math/box.h"
#include "common/math/index.h"

namespace rayfarm {

/// How the normal varies over a polygon with normals at its nodes (thesis 2.3.5).
enum class Smoothing : uint32_t { flat, phong, center };

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

/// Phong's interpolation: mean value coordinates (Floater 2003), which for triangles are the barycentric ones
/// and, unlike scan lines, do not depend on the polygon's orientation. Not normalised.
Vec3 phong_normal(std::span<const Vec3> points, std::span<const Vec3> normals, const Vec3& p,
                  const Vec3& plane_normal);

/// The box of the polygon's part inside `cell`; empty if there is none.
Box clipped_bounds(std::span<const Vec3> points, const Box& cell);

}  // namespace rayfarm
