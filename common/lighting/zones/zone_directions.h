#pragma once
// Directions over a hemisphere in cells of equal projected solid angle (Shirley, Sung and Brown 1991, section
// 3: "a spherical coordinate array of bins"). Here the bins are the cells of a square that the disk below the
// hemisphere is mapped to and back (Shirley and Chiu 1997): their sides are nearly alike, where bins even in
// sin²θ and φ are slivers about the normal, far wider than a lobe.
#include "common/lighting/surface.h"

namespace rayfarm {

/// The most cells along a side: 2,025 in all, no more than an array of 32 × 64.
inline constexpr uint32_t kMostDirectionCells = 45;

/// Cells along a side that tell a lobe cosⁿ apart: no wider than half the angle at which it falls to a half.
/// 0: it would take more than there may be.
uint32_t direction_cells_for(double exponent);

/// The place in [0, 1]² of a direction: `local` is unit, z along the normal.
Vec2 direction_place(const Vec3& local);
/// The direction of a place.
Vec3 direction_at(const Vec2& place);

/// A normal and what directions about it are counted from.
struct DirectionFrame {
  Vec3 tangent{0}, bitangent{0}, normal{0};
  DirectionFrame(const Vec3& n, const Vec3& across)
      : tangent(across), bitangent(glm::cross(n, across)), normal(n) {}
  Vec3 to_local(const Vec3& world) const {
    return {glm::dot(world, tangent), glm::dot(world, bitangent), glm::dot(world, normal)};
  }
  Vec3 to_world(const Vec3& local) const {
    return local.x * tangent + local.y * bitangent + local.z * normal;
  }
};

}  // namespace rayfarm
