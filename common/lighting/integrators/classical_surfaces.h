#pragma once
// Surfaces as the classical models see them (thesis 2.2): a colour, with coefficients for ambient, diffuse
// and specular light, and a shadow ray to each source (Equation 2.4). Those that the rays of a packet met
// stand side by side.
#include "common/lighting/frame_context.h"
#include "common/lighting/light_sampling.h"
#include "common/lighting/media.h"
#include "common/lighting/ray_counts.h"
#include "common/lighting/self_hits.h"
#include "common/lighting/surfaces.h"
#include "common/lighting/textured.h"

namespace rayfarm {

/// Where rays met surfaces, and the light that they see there. Rays that met nothing have none.
struct ClassicalSurfaces {
  ClassicalSurfaces() {}  // leaves the lanes as they are
  /// Rays and hits must outlive it.
  ClassicalSurfaces(const FrameContext& context, const RayPacket& of_rays, const Hit* of_hits)
      : rays(&of_rays), hits(of_hits), met(eval_surfaces(context.scene, context.pose, of_rays, of_hits, at)) {
    if (is_by_medium(context)) [[unlikely]]
      lay_on_surfaces(context.scene, met, at);
  }

  const RayPacket* rays;
  const Hit* hits;
  Surfaces at;
  uint32_t met;  ///< bits of the rays
  const Material* materials[kMostPacketRays];
  alignas(64) double diffuse_share[kMostPacketRays];
  alignas(64) double specular_share[kMostPacketRays];
  alignas(64) double shininess[kMostPacketRays];
  alignas(64) VectorLanes color;     ///< the materials', textured
  alignas(64) VectorLanes glow;      ///< what principled ones emit, textured
  alignas(64) VectorLanes diffuse;   ///< light that takes the surface's colour
  alignas(64) VectorLanes specular;  ///< light that does not
  const SampleId* ids[kMostPacketRays];
  uint32_t streams[kMostPacketRays];
  const Media* media[kMostPacketRays];  ///< that the ray came through; null: none

  /// The surface of ray i gets its material. No light yet. `width`: of the ray's cone at the hit; `stream`
  /// tells the rays of one sample apart, for their random numbers. `id` and `through` must outlive it.
  void begin(const FrameContext& context, size_t i, double width, const SampleId& id, uint32_t stream,
             const Media* through = nullptr) {
    ids[i] = &id;
    streams[i] = stream;
    media[i] = through;
    const Material* material = &context.scene.materials[at.material[i]];
    if (is_textured(*material)) return apply_textures(context, i, width);
    set_lane(color, i, material->color);
    set_material(i, *material);
  }
  /// The same for a surface that is as number `other` of others.
  void begin(size_t i, const ClassicalSurfaces& others, size_t other) {
    ids[i] = others.ids[other];
    streams[i] = others.streams[other];
    media[i] = others.media[other];
    set_lane(color, i, lane_of(others.color, other));
    set_material(i, *others.materials[other]);
    if (materials[i]->kind != MaterialKind::principled) return;
    set_lane(glow, i, lane_of(others.glow, other));
    diffuse_share[i] = others.diffuse_share[other];
    specular_share[i] = others.specular_share[other];
    shininess[i] = others.shininess[other];
  }

  Vec3 direction(size_t i) const { return rays->direction(i); }
  Color light(size_t i) const { return lane_of(color, i) * lane_of(diffuse, i) + lane_of(specular, i); }
  Interaction interaction(size_t i) const { return interaction_at(at[i], direction(i), *materials[i]); }
  bool has_reflection(size_t i) const {
    return materials[i]->reflect > 0 && has_reflected_rays(*materials[i]);
  }
  bool has_secondary_rays(size_t i) const { return has_reflection(i) || materials[i]->transmit > 0; }
  Color emission(const FrameContext& context, size_t i) const {
    if (materials[i]->kind == MaterialKind::principled)
      return at.is_front(i) || materials[i]->is_unlit ? lane_of(glow, i) : Color(0);
    return emission_at(context.scene, context.pose, hits[i].instance, *materials[i], interaction(i));
  }
  void add_specular(size_t i, const Color& more) { set_lane(specular, i, lane_of(specular, i) + more); }
  /// The first that a surface gets of what takes its colour.
  void add_ambient(const Scene& scene, size_t i, AmbientColour weighed_by) {
    const Color ambient = materials[i]->ambient * scene.head().ambient;
    if (weighed_by == AmbientColour::surface) [[likely]]
      set_lane(diffuse, i, ambient);
    else
      add_specular(i, ambient);
  }
  void add_ambient_and_emission(const FrameContext& context, size_t i) {
    add_ambient(context.scene, i, context.tables.settings.ambient_colour);
    if (is_luminaire(*materials[i])) add_specular(i, emission(context, i));
  }

 private:
  void set_material(size_t i, const Material& material) {
    materials[i] = &material;
    diffuse_share[i] = material.diffuse;
    specular_share[i] = material.specular;
    shininess[i] = material.shininess;
    set_lane(diffuse, i, Color(0));
    set_lane(specular, i, Color(0));
  }
  void apply_textures(const FrameContext& context, size_t i, double width);
};

/// How sources show in surfaces.
struct Highlights {
  enum class Shape { phong, torrance_sparrow } shape = Shape::phong;
  /// A reflected ray shows a luminous body itself; a highlight would count it again.
  bool has_reflected_rays = false;
};

/// Diffuse and specular terms with a shadow ray to each source in front of a surface. `counts` grows by the
/// shadow rays.
void add_direct_light(const FrameContext& context, const Highlights& highlights, ClassicalSurfaces& surfaces,
                      RayCounts& counts);

}  // namespace rayfarm
