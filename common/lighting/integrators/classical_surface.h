#pragma once
// Surfaces as the classical models see them (thesis 2.2): a colour, with coefficients for ambient, diffuse
// and specular light, and a shadow ray to each source (Equation 2.4).
#include "common/lighting/frame_context.h"
#include "common/lighting/light_sampling.h"
#include "common/lighting/ray_counts.h"
#include "common/lighting/textured.h"

namespace rayfarm {

/// Where a ray met a surface, and the light that it sees there.
struct ClassicalSurface {
  /// No light yet. `width`: of the ray's cone at the hit; `stream` tells the rays of one sample apart, for
  /// their random numbers.
  ClassicalSurface(const FrameContext& context, const Ray& ray, const Hit& hit, double width,
                   const SampleId& of_sample, uint32_t of_stream)
      : surface(eval_surface(context.scene, context.pose, ray, hit)),
        material(&context.scene.materials[surface.material]),
        color(material->color),
        direction(ray.direction),
        instance(hit.instance),
        id(of_sample),
        stream(of_stream) {
    if (is_textured(*material)) apply_textures(context, ray, hit, width);
  }

  Surface surface;
  const Material* material;
  Color color;        ///< the material's, textured
  Vec3 direction;     ///< of the ray
  uint32_t instance;  ///< that it met
  SampleId id;
  uint32_t stream;
  Color diffuse{0};   ///< light that takes the surface's colour
  Color specular{0};  ///< light that does not

  Color light() const { return color * diffuse + specular; }
  Interaction interaction() const { return interaction_at(surface, direction, *material); }
  bool has_secondary_rays() const { return material->reflect > 0 || material->transmit > 0; }
  Color emission(const FrameContext& context) const {
    return emission_at(context.scene, context.pose, instance, *material, interaction());
  }
  void add_ambient_and_emission(const FrameContext& context) {
    diffuse = material->ambient * context.scene.head().ambient;
    if (is_luminaire(*material)) specular += emission(context);
  }

 private:
  void apply_textures(const FrameContext& context, const Ray& ray, const Hit& hit, double width);
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
