#pragma once
// Polygons cut into triangles, concave ones too, and those whose holes are joined to their rim by bridges.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/math/vector.h"

namespace rayfarm {

/// Triangles of indices into `points` that cover the polygon once and run round the way it does; none is
/// without area. Corners in the middle of an edge are corners of triangles, too, so that neighbours that
/// share them leave no gap. Their number is n - 2, less what duplicate points and spikes cost. A polygon that
/// crosses itself gets some triangles, and no promise which. `normal` need only tell along which axis the
/// polygon can be looked at; either sign will do.
/// Source: ear clipping (Meisters, "Polygons Have Ears", 1975), with exact orientations, so that there always
/// is an ear.
std::vector<std::array<uint32_t, 3>> triangulate(std::span<const Vec3> points, const Vec3& normal);

/// The same for faces of meshes, into `triangles`: a fan from the first corner where that covers the face
/// once, as it does where the face is convex, planar or not.
void cut_face(std::span<const Vec3> points, std::vector<std::array<uint32_t, 3>>& triangles);

/// True if edges cross, or run along each other in the same direction: then some part of the plane lies
/// within the polygon more than once. The two sides of a bridge run in opposite directions.
bool crosses_itself(std::span<const Vec3> points, const Vec3& normal);

}  // namespace rayfarm
