#pragma once
// The surface at a hit: position, normals, material, and how far a ray that leaves it must start from it.
#include "common/hierarchy/traverser.h"
#include "common/materials/scattering.h"

namespace rayfarm {

/// Rounding leaves a hit within a few units in the last place (2^-52) of its surface, relative to the largest
/// number in the computation; 128 of them hold every case that the tests could provoke, at any scale.
constexpr double rounding_bound(double magnitude) {
  return 0x1p-45 * magnitude;
}

/// How much longer areas of normal `n` (unit, in the object) are in the world.
double area_scale(const InstancePose& place, const Vec3& n);

/// The largest number in the computation that places a primitive in the world whose own largest is `local`.
double magnitude_in_world(const InstancePose& place, double local);

/// Where a ray in `direction` starts: just off the surface, on the side to which it goes.
inline Vec3 ray_origin(const Vec3& p, const Vec3& geometric_normal, double offset, const Vec3& direction) {
  return p + (glm::dot(geometric_normal, direction) >= 0 ? offset : -offset) * geometric_normal;
}

struct Surface {
  Vec3 p{0};                 ///< in the world
  Vec3 geometric_normal{0};  ///< unit, on the viewer's side
  Vec3 shading_normal{0};    ///< unit, in the geometric normal's hemisphere
  bool is_front = true;      ///< the ray came from outside: from where polygons run counter-clockwise
  bool is_gouraud = false;   ///< the polygon shows the light at its corners
  uint32_t material = 0;
  double offset = 0;  ///< bounds the rounding error of p; grows with the numbers that p was computed from

  Vec3 ray_origin(const Vec3& direction) const {
    return rayfarm::ray_origin(p, geometric_normal, offset, direction);
  }
};

/// The vertices of the triangle that was hit, in its object's space. `scene`: where the part's shape stands
/// (Pose::shape_of).
std::array<Vec3, 3> triangle_vertices(const Scene& scene, uint32_t block_lane);

/// What a material is asked about. A shading normal that faces away, at a silhouette, has no mirror
/// direction: the surface's own normal stands in for it.
inline Interaction interaction_at(const Surface& surface, const Vec3& ray_direction,
                                  const Material& material) {
  Interaction at{-ray_direction, surface.shading_normal, surface.is_front,
                 surface.is_front ? material.index : 1 / material.index};
  if (!(glm::dot(at.to_viewer, at.normal) > 0)) at.normal = surface.geometric_normal;
  return at;
}

Surface eval_surface(const Scene& scene, const Pose& pose, const Ray& ray, const Hit& hit);

}  // namespace rayfarm
