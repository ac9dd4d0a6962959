#pragma once
// Principled materials where rays meet them: what their textures say there.
#include "common/lighting/surface.h"
#include "common/materials/principled.h"

namespace rayfarm {

/// Where a surface is asked about its textures, and how they change along it.
struct SurfacePatch {
  TexturePoint at;
  Vec3 tangent{0}, bitangent{0};  ///< unit, in the world
  double step = 0;                ///< along each of them, in the world
  Vec3 dp_x{0}, dp_y{0};          ///< of a step, in the object's space
  Vec2 duv_x{0}, duv_y{0};        ///< of a step
};
/// `width`: of the ray's cone there, in the world.
SurfacePatch patch_at(const Scene& scene, const Pose& pose, const Ray& ray, const Hit& hit, double width,
                      const Surface& surface);

/// One of a material's parameters; `rgb` of a colour, else in all three.
Color eval_source(const Scene& scene, const PrincipledSource& source, const TexturePoint& at);

/// Its parameters at a point.
PrincipledPoint eval_principled_point(const Scene& scene, const Material& material, const TexturePoint& at);

/// The material as its textures have it; normal maps tilt the surface's shading normal. `point` gets its
/// parameters. `patch`: of a material without textures any will do.
Material principled_at(const Scene& scene, const Material& material, const SurfacePatch& patch,
                       const Vec3& ray_direction, Surface& surface, PrincipledPoint& point);

}  // namespace rayfarm
