#pragma once
// Bicubic Bézier patches (thesis 2.3.3) as meshes.
#include <array>
#include <span>

#include "common/description/scene_description.h"

namespace rayfarm {

/// Sixteen control points, u fastest.
using BezierPatch = std::array<Vec3, 16>;

/// Into how many parts both sides of every patch must be cut so that triangles stand off the surface by no
/// more than `error`; more than `most` are not looked for. After Filip, Magedson and Markot, "Surface
/// algorithms using bounds on derivatives" (1986).
uint32_t divisions_for(std::span<const BezierPatch> patches, double error, uint32_t most);

/// Each patch as divisions² pairs of triangles over points of the surface, with the surface's normals,
/// counter-clockwise along u and then v. Patches that share the control points of an edge share the points
/// on it to the bit, whichever way they run along it.
MeshShape dice_patches(std::span<const BezierPatch> patches, uint32_t divisions, Smoothing smoothing);

}  // namespace rayfarm
