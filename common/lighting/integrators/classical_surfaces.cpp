#include "common/lighting/integrators/classical_surfaces.h"

#include <bit>
#include <numbers>

#include "common/lighting/glass_shadows.h"
#include "common/lighting/holes.h"
#include "common/lighting/integrators/gouraud.h"
#include "common/lighting/item_buffers.h"
#include "common/lighting/participating_media.h"
#include "common/lighting/torrance_sparrow.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/lighting/integrators/classical_surfaces.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "common/lighting/surface-inl.h"
#include "common/math/portable_pow-inl.h"

#ifndef RAYFARM_COMMON_LIGHTING_INTEGRATORS_CLASSICAL_SURFACES_CPP_
#define RAYFARM_COMMON_LIGHTING_INTEGRATORS_CLASSICAL_SURFACES_CPP_
namespace rayfarm {

/// What one source sends to surfaces if nothing is in its way.
struct Incoming {
  Incoming() {}                      // leaves the lanes as they are
  alignas(64) VectorLanes target;    ///< where a shadow ray ends
  alignas(64) VectorLanes to_light;  ///< of any length
  alignas(64) VectorLanes light;     ///< what a white surface that faces the light shows
  alignas(64) double cosine_times_distance[kMostPacketRays];
  RayPacket shadow_rays;
};

}  // namespace rayfarm
#endif

HWY_BEFORE_NAMESPACE();
namespace rayfarm {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Light from a point without falloff.
void come_from_point(const Surfaces& at, const Vec3& position, const Color& light, Incoming& in) {
  for (size_t lane = 0; lane < kMostPacketRays; lane += kLanes) {
    const Real3 target = all(position);
    store3(target, in.target, lane);
    store3(target - load3(at.p, lane), in.to_light, lane);
    store3(all(light), in.light, lane);
  }
}

/// Light from far away; `to_light`: unit.
void come_from_afar(const Surfaces& at, const Vec3& to_light, double far_away, const Color& light,
                    Incoming& in) {
  for (size_t lane = 0; lane < kMostPacketRays; lane += kLanes) {
    store3(load3(at.p, lane) + real(far_away) * all(to_light), in.target, lane);
    store3(all(to_light), in.to_light, lane);
    store3(all(light), in.light, lane);
  }
}

/// Shadow rays to the light, and the bits of the surfaces that face it.
uint32_t face_light(const Surfaces& at, Incoming& in) {
  const RealTag d;
  uint32_t facing = 0;
  for (size_t lane = 0; lane < kMostPacketRays; lane += kLanes) {
    const Real3 to_light = load3(in.to_light, lane);
    const Real cosine = dot(load3(at.shading_normal, lane), to_light);
    hn::Store(cosine, d, in.cosine_times_distance + lane);
    facing |= bits_of(cosine > hn::Zero(d)) << lane;
    const Real3 origin = ray_origin(load3(at.p, lane), load3(at.geometric_normal, lane),
                                    hn::Load(d, at.offset + lane), to_light);
    store3(origin, in.shadow_rays.origins, lane);
    store3(load3(in.target, lane) - origin, in.shadow_rays.directions, lane);
    hn::Store(real(1), d, in.shadow_rays.t_max + lane);
  }
  return facing;
}

/// Lambert's diffuse and Phong's specular term (Equation 2.4): of the surfaces that are `lit`, and of those
/// with a highlight.
void add_lit(const Incoming& in, uint32_t lit, uint32_t highlighted, ClassicalSurfaces& surfaces) {
  const RealTag d;
  for (size_t lane = 0; lane < kMostPacketRays; lane += kLanes) {
    const Truth is_lit = truth_of(lanes_from(lit, lane));
    const Real3 to_light = load3(in.to_light, lane), light = load3(in.light, lane);
    const Real distance = hn::Sqrt(dot(to_light, to_light));
    const Real lambert = hn::Load(d, surfaces.diffuse_share + lane) *
                         (hn::Load(d, in.cosine_times_distance + lane) / distance);
    const Real3 diffuse = load3(surfaces.diffuse, lane);
    store3(select(is_lit, diffuse + lambert * light, diffuse), surfaces.diffuse, lane);
    if (lanes_from(highlighted, lane) == 0) continue;
    const Real3 n = load3(surfaces.at.shading_normal, lane),
                direction = load3(surfaces.rays->directions, lane);
    const Real3 reflected = direction - (real(2) * dot(direction, n)) * n;
    const Real cosine = dot(reflected, to_light) / distance;
    const Truth shows = hn::And(truth_of(lanes_from(highlighted, lane)), cosine > hn::Zero(d));
    if (hn::AllFalse(d, shows)) continue;
    const Real phong =
        hn::Load(d, surfaces.specular_share + lane) * pow(cosine, hn::Load(d, surfaces.shininess + lane));
    const Real3 specular = load3(surfaces.specular, lane);
    store3(select(shows, specular + phong * light, specular), surfaces.specular, lane);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace rayfarm
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayfarm {

HWY_EXPORT(come_from_point);
HWY_EXPORT(come_from_afar);
HWY_EXPORT(face_light);
HWY_EXPORT(add_lit);

namespace {

Vec2 light_point(const FrameContext& context, const ClassicalSurfaces& s, size_t i, uint32_t light) {
  if (!has_extent(context.scene.lights[light])) return Vec2(0);
  const auto stream = static_cast<uint32_t>(mix_bits(uint64_t{s.streams[i]} << 32 | light));
  return context.tables.sampler.point(*s.ids[i], stream << 8 | dimension::kLightPoint);
}

/// What source number `light` sends to the surfaces of `wanted`.
void send_light(const FrameContext& context, uint32_t number, uint32_t wanted, const ClassicalSurfaces& s,
                Incoming& in) {
  const Light& light = context.scene.lights[number];
  const LightPlace& place = context.pose[light];
  if (light.kind == LightKind::point) {
    HWY_DYNAMIC_DISPATCH(come_from_point)(s.at, place.position, light.color, in);
  } else if (light.kind == LightKind::distant) {
    const LightSample sample = sample_light(context.scene, context.pose, light, Vec3(0), Vec2(0));
    HWY_DYNAMIC_DISPATCH(come_from_afar)
    (s.at, sample.to_light, context.scene.head().far_away, sample.incident / std::numbers::pi, in);
  } else {
    for_each_lane(wanted, [&](size_t i) {
      const LightSample sample = sample_light(context.scene, context.pose, light, lane_of(s.at.p, i),
                                              light_point(context, s, i, number));
      set_lane(in.target, i, sample.target);
      set_lane(in.to_light, i, sample.to_light);
      set_lane(in.light, i, sample.incident / std::numbers::pi);
    });
  }
}

Media media_before(const ClassicalSurfaces& surfaces, size_t i) {
  return surfaces.media[i] ? *surfaces.media[i] : Media();
}

/// As find_blocked, of rays that know what they are in.
uint32_t find_really_blocked(const FrameContext& context, const ClassicalSurfaces& surfaces,
                             const RayPacket& rays, uint32_t among) {
  std::array<Media, kMostPacketRays> media;
  MediaOfRays of_rays{};
  for_each_lane(among, [&](size_t i) {
    media[i] = media_before(surfaces, i);
    leave(context.scene, surfaces.at[i], rays.direction(i), media[i]);
    of_rays[i] = &media[i];
  });
  return any_real_hits(context, rays, of_rays, among);
}

/// Weakens what comes through glass; returns the surfaces that light reaches of those that face it.
uint32_t lit_through_glass(const FrameContext& context, const ClassicalSurfaces& surfaces, uint32_t facing,
                           uint32_t blocked, Incoming& in) {
  uint32_t lit = facing;
  for_each_lane(facing, [&](size_t i) {
    Media media = media_before(surfaces, i);
    if (is_by_medium(context)) [[unlikely]]
      leave(context.scene, surfaces.at[i], in.shadow_rays.direction(i), media);
    const Color left = light_through_glass(context, in.shadow_rays[i], blocked >> i & 1, media);
    if (left == Color(0)) lit &= ~(1u << i);
    set_lane(in.light, i, lane_of(in.light, i) * left);
  });
  return lit;
}

/// Lets light through surfaces that are not there.
void light_holes(const FrameContext& context, const ClassicalSurfaces& surfaces, uint32_t& blocked,
                 Incoming& in) {
  for_each_lane(blocked, [&](size_t i) {
    Media media = media_before(surfaces, i);
    const bool is_aware = is_by_medium(context);
    if (is_aware) leave(context.scene, surfaces.at[i], in.shadow_rays.direction(i), media);
    const double left = light_through_holes(context, in.shadow_rays[i], is_aware ? &media : nullptr);
    if (!(left > 0)) return;
    set_lane(in.light, i, left * lane_of(in.light, i));
    blocked &= ~(1u << i);
  });
}

/// Weakens light by the media that stand in boxes on its way.
void weaken_in_media(const FrameContext& context, uint32_t lit, Incoming& in) {
  for_each_lane(lit, [&](size_t i) {
    set_lane(in.light, i, lane_of(in.light, i) * transmittance(context.scene, in.shadow_rays[i]));
  });
}

void add_facets(const Incoming& in, uint32_t highlighted, ClassicalSurfaces& surfaces) {
  for_each_lane(highlighted, [&](size_t i) {
    const Vec3 to_light = lane_of(in.to_light, i);
    surfaces.add_specular(i, facet_highlight(*surfaces.materials[i], lane_of(surfaces.at.shading_normal, i),
                                             to_light / glm::length(to_light), -surfaces.direction(i)) *
                                 lane_of(in.light, i));
  });
}

/// Bits of the rays of `among` for which it holds.
template <typename Condition>
uint32_t where(uint32_t among, Condition condition) {
  uint32_t bits = 0;
  for_each_lane(among, [&](size_t i) { bits |= static_cast<uint32_t>(condition(i)) << i; });
  return bits;
}

}  // namespace

void ClassicalSurfaces::apply_textures(const FrameContext& context, size_t i, double width) {
  const double choice = context.scene.materials[at.material[i]].kind == MaterialKind::mix
                            ? context.tables.sampler.point(*ids[i], dimension::of_mix(streams[i])).x
                            : 0;
  Surface surface = at[i];
  const Material material =
      textured(context.scene, context.pose, (*rays)[i], hits[i], width, choice, surface);
  set_lane(color, i, material.color);
  set_lane(glow, i, material.emission);
  at.set(i, surface);
  set_material(i, material);
  materials[i] = &context.scene.materials[surface.material];
}

void add_direct_light(const FrameContext& context, const Highlights& highlights, ClassicalSurfaces& surfaces,
                      RayCounts& counts) {
  const uint32_t shaded = surfaces.met & ~surfaces.at.gouraud;
  const uint32_t shiny = where(shaded, [&](size_t i) { return surfaces.specular_share[i] > 0; });
  const bool is_glass_crossed = context.tables.settings.glass_shadows != GlassShadows::blocked;
  for (uint32_t number = 0; shaded && number < context.scene.lights.size(); ++number) {
    const Light& light = context.scene.lights[number];
    if (light.kind == LightKind::environment)
      continue;  // diffuse rays meet it, or ambient light stands for it
    uint32_t wanted = shaded, highlighted = shiny;
    if (highlights.has_reflected_rays && has_extent(light)) {
      const uint32_t mirrored = where(shaded, [&](size_t i) { return surfaces.has_reflection(i); });
      highlighted &= ~mirrored;
      wanted &= ~where(mirrored, [&](size_t i) { return !(surfaces.diffuse_share[i] > 0); });
    }
    Incoming in;
    send_light(context, number, wanted, surfaces, in);
    const uint32_t facing = HWY_DYNAMIC_DISPATCH(face_light)(surfaces.at, in) & wanted;
    if (!facing) continue;
    counts[RayKind::shadow] += static_cast<uint64_t>(std::popcount(facing));
    uint32_t blocked = is_by_medium(context) ? find_really_blocked(context, surfaces, in.shadow_rays, facing)
                                             : find_blocked(context, number, in.shadow_rays, facing, counts);
    if (has_holes(context) && !is_glass_crossed) [[unlikely]]
      light_holes(context, surfaces, blocked, in);
    const uint32_t lit =
        is_glass_crossed ? lit_through_glass(context, surfaces, facing, blocked, in) : facing & ~blocked;
    if (!lit) continue;
    if (!context.scene.media.empty()) weaken_in_media(context, lit, in);
    const bool has_facets = highlights.shape == Highlights::Shape::torrance_sparrow;
    HWY_DYNAMIC_DISPATCH(add_lit)(in, lit, has_facets ? 0 : lit & highlighted, surfaces);
    if (has_facets) add_facets(in, lit & highlighted, surfaces);
  }
  for_each_lane(surfaces.met & surfaces.at.gouraud,
                [&](size_t i) { add_gouraud_light(context, highlights, surfaces, i, counts); });
}

}  // namespace rayfarm
#endif
