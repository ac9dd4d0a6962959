#include "common/lighting/glass_shadows.h"

#include "common/lighting/holes.h"
#include "common/lighting/self_hits.h"

namespace rayfarm {

Color light_through_glass(const FrameContext& context, Ray ray, bool is_blocked, Media media) {
  const bool is_weakened = context.tables.settings.glass_shadows == GlassShadows::transparent;
  const bool by_medium = is_by_medium(context);
  const Vec3 target = ray.origin + ray.direction;
  Color left(1);
  for (int crossings = 0; crossings <= kMostCrossings; ++crossings) {
    Hit hit = is_blocked ? closest_hit(context.scene, context.pose, ray) : Hit();
    if (by_medium) hit = next_real_hit(context, ray, media, hit);
    const bool arrives = !(hit.is_hit() && hit.t < ray.t_max);
    if (is_weakened && !media.is_in_air())
      left *= media.transmittance(context.scene, (arrives ? 1 : hit.t) * glm::length(ray.direction));
    if (arrives) return left;
    Surface surface = eval_surface(context.scene, context.pose, ray, hit);
    const Material& material = context.scene.materials[surface.material];
    const double open = material.is_pierced ? open_share(context, ray, hit, surface, 0) : 0;
    if (!(material.transmit > 0 || open > 0)) return Color(0);
    if (is_weakened || !(material.transmit > 0)) {
      left *= open + (1 - open) * material.transmit * material.interior;
      if (left == Color(0)) return left;
      if (has_inside(material) && !by_medium) media.cross(surface.material, surface.is_front);
    }
    if (by_medium) {
      surface = laid_on_surface(context.scene, surface);
      leave(context.scene, surface, ray.direction, media);
    }
    ray.origin = surface.ray_origin(ray.direction);
    ray.direction = target - ray.origin;
  }
  return Color(0);
}

}  // namespace rayfarm
