#pragma once
// Surfaces as the classical models see them (thesis 2.2): a colour, with coefficients for ambient, diffuse
// and specular light, and a shadow ray to each source (Equation 2.4).
#include "common/lighting/frame_context.h"
#include "common/lighting/light_sampling.h"
#include "common/lighting/media.h"
#include "common/lighting/ray_counts.h"
#include "common/lighting/textured.h"

namespace rayfarm {

/// Where a ray met a surface, and the light that it sees there.
struct ClassicalSurface {
  /// No light yet. The hit must outlive it. `width`: of the ray's cone at the hit; `stream` tells the
  /// rays of one sample apart, for their random numbers.
  ClassicalSurface(const FrameContext& context, const Ray& of_ray, const Hit& of_hit, double width,
                   const SampleId& of_sample, uint32_t of_stream)
      : surface(eval_surface(context.scene, context.pose, of_ray, of_hit)),
        material(&context.scene.materials[surface.material]),
        color(material->color),
        direction(of_ray.direction),
        ray_origin(of_ray.origin),
        hit(&of_hit),
        id(of_sample),
        stream(of_stream) {
    if (is_textured(*material)) apply_textures(context, of_ray, width);
  }

  Surface surface;
  const Material* material;
  Color color;                 ///< the material's, textured
  Vec3 direction, ray_origin;  ///< of the ray
  const Hit* hit;
  SampleId id;
  uint32_t stream;
  const Media* media = nullptr;  ///< that the ray came through; null: none
  Color diffuse{0};              ///< light that takes the surface's colour
  Color specular{0};             ///< light that does not

  Color light() const { return color * diffuse + specular; }
  Interaction interaction() const { return interaction_at(surface, direction, *material); }
  bool has_secondary_rays() const { return has_reflection() || material->transmit > 0; }
  bool has_reflection() const { return material->reflect > 0 && has_reflected_rays(*material); }
  Color emission(const FrameContext& context) const {
    return emission_at(context.scene, context.pose, hit->instance, *material, interaction());
  }
  void add_ambient(const Scene& scene, AmbientColour weighed_by) {
    const Color ambient = material->ambient * scene.head().ambient;
    if (weighed_by == AmbientColour::surface) [[likely]]
      diffuse = ambient;
    else
      specular += ambient;
  }
  void add_ambient_and_emission(const FrameContext& context) {
    add_ambient(context.scene, context.tables.settings.ambient_colour);
    if (is_luminaire(*material)) specular += emission(context);
  }

 private:
  void apply_textures(const FrameContext& context, const Ray& ray, double width);
};

/// How sources show in surfaces.
struct Highlights {
  enum class Shape { phong, torrance_sparrow } shape = Shape::phong;
  /// A reflected ray shows a luminous body itself; a highlight would count it again.
  bool has_reflected_rays = false;
};

/// Diffuse and specular terms with a shadow ray to each source in front of a surface, for up to
/// kMostPacketRays surfaces. `counts` grows by the shadow rays.
void add_direct_light(const FrameContext& context, const Highlights& highlights,
                      std::span<ClassicalSurface> surfaces, RayCounts& counts);

}  // namespace rayfarm
