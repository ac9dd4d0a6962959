#pragma once
// Ullner's parametric quadrilateral (thesis 2.3.3; S. P. Ullner, "Parallel machines for computer graphics",
// 1983): four corners that need not lie in a plane, and between them p = a + u b + v c + u v d.
#include "common/shapes/quadric.h"

namespace rayfarm {

/// In the order in which they follow each other: (u, v) = (0, 0), (1, 0), (1, 1), (0, 1).
using PatchCorners = std::array<Vec3, 4>;

/// True if the corners lie in a plane to a millionth of their size: then it is a polygon.
bool is_planar(const PatchCorners& corners);

/// The patch as what it is, a quadric (a hyperbolic paraboloid) cut by planes. In the coordinates (x, y, z)
/// of p = a + x b + y c + z d it is z = x y, and u = x, v = y: so planes 0 to 3 are those of u >= 0, u <= 1,
/// v >= 0 and v <= 1. Its gradient points to the side from which the corners run counter-clockwise. The
/// corners must not lie in a plane.
Quadric make_patch(const PatchCorners& corners, std::array<Vec4, 4>& planes);

/// (u, v) of a point of the patch.
Vec2 patch_parameters(std::span<const Vec4> planes, const Vec3& p);

}  // namespace rayfarm
