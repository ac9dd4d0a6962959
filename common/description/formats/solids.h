#pragma once
// Solids as meshes of polygons: closed, outward, over shared vertices.
#include <span>

#include "common/description/scene_description.h"

namespace rayfarm {

/// The profile, points (r, y), turned about the y axis in `sides` steps: a quadrilateral for each step of
/// each line, a triangle where the line ends on the axis, none where it runs along it. A profile whose last
/// point is its first is a ring; an end that stands off the axis gets a polygon of `sides` corners as its
/// lid. Which way the profile runs makes no difference; it must not cross itself, nor be without area. Smooth
/// solids have normals about the axis as a curved surface has; along the profile they are the mean of those
/// of neighbouring lines that turn by no more than `crease` degrees, and a line's own otherwise.
MeshShape make_lathe(std::span<const Vec2> profile, uint32_t sides, Smoothing smoothing, double crease);

/// The loop that a profile makes with the axis; a ring is a loop itself.
std::vector<Vec2> loop_of_profile(std::span<const Vec2> profile);

/// The polygon, points (x, z), as floor at y = 0 and roof at y = `height`, and a wall along each of its
/// edges. Which way it runs makes no difference; it must not cross itself, nor be without area.
MeshShape make_prism(std::span<const Vec2> polygon, double height);

/// Twice the signed area of a polygon in the plane.
double twice_area(std::span<const Vec2> polygon);

}  // namespace rayfarm
