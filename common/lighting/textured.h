#pragma once
// Materials whose colour, shape or substance a texture varies over their surface.
#include "common/lighting/surface.h"
#include "common/materials/principled.h"

namespace rayfarm {

/// True if `textured` has to say what is there; of principled materials it always has.
inline bool is_textured(const Material& material) {
  return material.texture != kNone || material.bump != kNone || material.is_colored ||
         material.kind == MaterialKind::principled;
}

/// The parameters (u, v) of a primitive at a point in its object's space. Spheres: longitude from the x axis
/// and height angle about y; quadrics: the same about the middle of their bounds, v along y; bilinear patches
/// and quadrilaterals: the parameters of Ullner's bilinear patch; other polygons: along the first edge and
/// across it, over their extent; triangles: their mesh's coordinates, or the weights of the second and third
/// vertex; faces: their mesh's coordinates, or as polygons.
Vec2 surface_parameters(const Scene& scene, const Hit& hit, const Vec3& p);

/// The second pair of a triangle whose mesh has two, else the same.
Vec2 second_parameters(const Scene& scene, const Hit& hit, const Vec3& p);

/// The colour and opacity between the vertices of a mesh that gives them, else white.
Vec4 vertex_color(const Scene& scene, const Hit& hit, const Vec3& p);

/// The surface's material as textures and colours of vertices have it where the ray met it, whose shading
/// normal a bump map tilts. Of a mix `choice`, uniform in [0, 1), chooses the part with the probability that
/// its texture gives it; the surface then is of that part. So each look is there as often as it should be, in
/// every lighting model, and the mean over samples is the mean of the parts' light. `width`: of the ray's
/// cone there, in the world. `point` gets the parameters of a principled material.
Material textured(const Scene& scene, const Pose& pose, const Ray& ray, const Hit& hit, double width,
                  double choice, Surface& surface, PrincipledPoint& point);
inline Material textured(const Scene& scene, const Pose& pose, const Ray& ray, const Hit& hit, double width,
                         double choice, Surface& surface) {
  PrincipledPoint point;
  return textured(scene, pose, ray, hit, width, choice, surface, point);
}

}  // namespace rayfarm
