#include "common/lighting/integrators/classical_surface.h"

#include <numbers>

#include "common/lighting/glass_shadows.h"
#include "common/lighting/integrators/gouraud.h"
#include "common/lighting/torrance_sparrow.h"
#include "common/math/portable_math.h"

namespace rayfarm {
namespace {

/// A surface that faces a light.
struct Facing {
  ClassicalSurface* surface;
  Vec3 to_light;
  double cosine_times_distance;
  Color light;  ///< what a white surface that faces the light shows
  bool has_highlight;
};

Vec2 light_point(const FrameContext& context, const ClassicalSurface& s, uint32_t light) {
  if (!has_extent(context.scene.lights[light])) return Vec2(0);
  const auto stream = static_cast<uint32_t>(mix_bits(uint64_t{s.stream} << 32 | light));
  return context.tables.sampler.point(s.id, stream << 8 | dimension::kLightPoint);
}

void add_light(const Facing& facing, Highlights::Shape shape) {
  ClassicalSurface& s = *facing.surface;
  const double distance = glm::length(facing.to_light);
  s.diffuse += (s.material->diffuse * (facing.cosine_times_distance / distance)) * facing.light;
  if (!facing.has_highlight || !(s.material->specular > 0)) return;
  const Vec3& n = s.surface.shading_normal;
  if (shape == Highlights::Shape::torrance_sparrow) {
    s.specular += facet_highlight(*s.material, n, facing.to_light / distance, -s.direction) * facing.light;
    return;
  }
  const Vec3 reflected = s.direction - 2 * glm::dot(s.direction, n) * n;
  const double cosine = glm::dot(reflected, facing.to_light) / distance;
  if (cosine > 0)
    s.specular += (s.material->specular * portable_pow(cosine, s.material->shininess)) * facing.light;
}

}  // namespace

void ClassicalSurface::apply_textures(const FrameContext& context, const Ray& ray, double width) {
  const double choice =
      material->kind == MaterialKind::mix ? context.tables.sampler.point(id, dimension::of_mix(stream)).x : 0;
  color = textured(context.scene, context.pose, ray, *hit, width, choice, surface).color;
  material = &context.scene.materials[surface.material];
}

void add_direct_light(const FrameContext& context, const Highlights& highlights,
                      std::span<ClassicalSurface> surfaces, RayCounts& counts) {
  for (uint32_t i = 0; i < context.scene.lights.size(); ++i) {
    const Light& light = context.scene.lights[i];
    if (light.kind == LightKind::environment)
      continue;  // diffuse rays meet it, or ambient light stands for it
    const LightPlace& place = context.pose[light];
    RayPacket rays;
    OfPacket<Facing> facing;
    for (ClassicalSurface& s : surfaces) {
      if (s.surface.is_gouraud) continue;
      const bool is_mirrored = highlights.has_reflected_rays && has_extent(light) && s.has_reflection();
      if (is_mirrored && !(s.material->diffuse > 0)) continue;
      Vec3 target = place.position;
      Facing f{&s, target - s.surface.p, 0, light.color, !is_mirrored};
      if (light.kind != LightKind::point) {
        const LightSample sample =
            sample_light(context.scene, context.pose, light, s.surface.p, light_point(context, s, i));
        target = sample.target;
        f.to_light = sample.to_light;
        f.light = sample.incident / std::numbers::pi;
      }
      f.cosine_times_distance = glm::dot(s.surface.shading_normal, f.to_light);
      if (!(f.cosine_times_distance > 0)) continue;
      const Vec3 origin = s.surface.ray_origin(f.to_light);
      rays.push_back(origin, target - origin, 1);
      facing.push_back(f);
    }
    if (rays.empty()) continue;
    counts[RayKind::shadow] += rays.size;
    const uint32_t blocked = any_hits(context.scene, context.pose, rays);
    const bool is_glass_crossed = context.tables.settings.glass_shadows != GlassShadows::blocked;
    for (size_t k = 0; k < facing.size(); ++k) {
      const bool is_blocked = blocked >> k & 1;
      if (is_glass_crossed) {
        const Media* const media = facing[k].surface->media;
        const Color left = light_through_glass(context, rays[k], is_blocked, media ? *media : Media());
        if (left == Color(0)) continue;
        facing[k].light *= left;
      } else if (is_blocked) {
        continue;
      }
      add_light(facing[k], highlights.shape);
    }
  }
  for (ClassicalSurface& s : surfaces)
    if (s.surface.is_gouraud) add_gouraud_light(context, highlights, s, counts);
}

}  // namespace rayfarm
