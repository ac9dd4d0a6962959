#pragma once
// Principled materials where rays meet them: what their textures say there.
#include "common/lighting/surface.h"
#include "common/materials/principled.h"

namespace rayfarm {

/// A set of coordinates (u, v), and how they change along the surface.
struct PatchCoordinates {
  Vec2 uv{0};
  Vec2 duv_x{0}, duv_y{0};  ///< of a step
  double width = 0;         ///< of what the ray sees, for filtering
};

/// Where a surface is asked about its textures, and how they change along it.
struct SurfacePatch {
  Vec3 p{0};                      ///< in the object's space
  double width = 0;               ///< of what the ray sees, there
  Vec3 tangent{0}, bitangent{0};  ///< unit, in the world
  double step = 0;                ///< along each of them, in the world
  Vec3 dp_x{0}, dp_y{0};          ///< of a step, in the object's space
  std::array<PatchCoordinates, 2> sets;
  Vec4 color{1};  ///< of vertices: linear Rec. 709 and opacity

  TexturePoint at() const { return {p, sets[0].uv, width, sets[0].width}; }
};
/// `width`: of the ray's cone there, in the world.
SurfacePatch patch_at(const Scene& scene, const Pose& pose, const Ray& ray, const Hit& hit, double width,
                      const Surface& surface);

/// One of a material's parameters; `rgb` of a colour, else in all three.
Color eval_source(const Scene& scene, const PrincipledSource& source, const SurfacePatch& patch);

/// Its parameters at a point.
PrincipledPoint eval_principled_point(const Scene& scene, const Material& material,
                                      const SurfacePatch& patch);

/// The material as its textures have it; normal maps tilt the surface's shading normal. `point` gets its
/// parameters. `patch`: of a material without textures and colours of vertices any will do.
Material principled_at(const Scene& scene, const Material& material, const SurfacePatch& patch,
                       const Vec3& ray_direction, Surface& surface, PrincipledPoint& point);

}  // namespace rayfarm
