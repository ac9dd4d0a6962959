#include "common/lighting/glass_shadows.h"

namespace rayfarm {

Color light_through_glass(const FrameContext& context, Ray ray, bool is_blocked, Media media) {
  const bool is_weakened = context.tables.settings.glass_shadows == GlassShadows::transparent;
  const Vec3 target = ray.origin + ray.direction;
  Color left(1);
  for (int crossings = 0; crossings <= kMostCrossings; ++crossings) {
    const Hit hit = is_blocked ? closest_hit(context.scene, context.pose, ray) : Hit();
    const bool arrives = !(hit.is_hit() && hit.t < ray.t_max);
    if (is_weakened && !media.is_in_air())
      left *= media.transmittance(context.scene, (arrives ? 1 : hit.t) * glm::length(ray.direction));
    if (arrives) return left;
    const Surface surface = eval_surface(context.scene, context.pose, ray, hit);
    const Material& material = context.scene.materials[surface.material];
    if (!(material.transmit > 0)) return Color(0);
    if (is_weakened) {
      left *= material.transmit * material.interior;
      if (left == Color(0)) return left;
      if (material.kind == MaterialKind::dielectric) media.cross(surface.material, surface.is_front);
    }
    ray.origin = surface.ray_origin(ray.direction);
    ray.direction = target - ray.origin;
  }
  return Color(0);
}

}  // namespace rayfarm
