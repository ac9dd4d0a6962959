#pragma once
// Materials whose colour or shape a texture varies over their surface.
#include "common/lighting/surface.h"

namespace rayfarm {

inline bool is_textured(const Material& material) {
  return material.texture != kNone || material.bump != kNone;
}

/// The parameters (u, v) of a primitive at a point in its object's space. Spheres: longitude from the x axis
/// and height angle about y; quadrics: the same about the middle of their bounds, v along y; quadrilaterals:
/// the parameters of Ullner's bilinear patch; other polygons: along the first edge and across it, over their
/// extent; triangles: their mesh's coordinates, or the weights of the second and third vertex; faces: their
/// mesh's coordinates, or as polygons.
Vec2 surface_parameters(const Scene& scene, const Hit& hit, const Vec3& p);

/// The material as the texture has it where the ray met the surface, whose shading normal a bump map tilts.
/// `width`: of the ray's cone there, in the world.
Material textured(const Scene& scene, const Pose& pose, const Ray& ray, const Hit& hit,
                  const Material& material, double width, Surface& surface);

}  // namespace rayfarm
