#include "common/lighting/lighting_tree.h"

#include "common/math/portable_math.h"

namespace rayfarm {
namespace {

class LightingTree {
 public:
  LightingTree(const Scene& scene, const Pose& pose, const RenderSettings& settings, RayCounts& counts)
      : scene_(scene), pose_(pose), settings_(settings), counts_(counts) {}

  /// `weight` is the largest share that this ray's colour can have in the pixel.
  Color trace(const Ray& ray, uint32_t depth, double weight) {
    const Hit hit = closest_hit(scene_, pose_, ray);
    if (!hit.is_hit()) return scene_.head().background;
    const Surface surface = eval_surface(scene_, pose_, ray, hit);
    const MaterialRecord& material = scene_.materials[surface.material];
    Color color = direct_light(surface, material, ray.direction);
    if (settings_.lighting == LightingModel::whitted && depth < settings_.max_depth)
      color += secondary_light(surface, material, ray.direction, depth, weight);
    return color;
  }

 private:
  /// Ambient, diffuse and specular terms with a shadow ray to each light in front of the surface.
  Color direct_light(const Surface& surface, const MaterialRecord& material, const Vec3& direction) {
    Color diffuse = material.ambient * scene_.head().ambient;
    Color specular(0);
    const Vec3& n = surface.shading_normal;
    const Vec3 reflected = direction - 2 * glm::dot(direction, n) * n;
    for (const LightRecord& light : scene_.lights) {
      const Vec3 to_light = light.position - surface.p;
      const double facing = glm::dot(n, to_light);
      if (!(facing > 0)) continue;
      const Vec3 origin = surface.ray_origin(to_light);
      ++counts_.shadow;
      if (any_hit(scene_, pose_, {origin, light.position - origin, 1})) continue;
      const double distance = glm::length(to_light);
      diffuse += (material.diffuse * (facing / distance)) * light.color;
      if (material.specular > 0) {
        const double cosine = glm::dot(reflected, to_light) / distance;
        if (cosine > 0)
          specular += (material.specular * portable_pow(cosine, material.shininess)) * light.color;
      }
    }
    return material.color * diffuse + specular;
  }

  /// Reflected and transmitted terms. A surface that transmits also spawns a reflected ray, even one of
  /// weight 0 if there is no cut-off: that is how published ray counts were made. Total internal reflection
  /// sends the transmitted share along the mirror direction.
  Color secondary_light(const Surface& surface, const MaterialRecord& material, const Vec3& direction,
                        uint32_t depth, double weight) {
    if (!(material.reflect > 0 || material.transmit > 0)) return Color(0);
    // A shading normal that faces away, at a silhouette, has no mirror direction: the surface's own normal
    // has.
    Vec3 n = surface.shading_normal;
    if (!(glm::dot(direction, n) < 0)) n = surface.geometric_normal;
    const double cosine = -glm::dot(direction, n);
    double reflect = material.reflect;
    Color color(0);
    if (material.transmit > 0) {
      // Snell: with eta the ratio of the indices outside and inside of the new side.
      const double eta = surface.is_front ? 1 / material.index : material.index;
      const double k = 1 - eta * eta * (1 - cosine * cosine);
      if (k < 0) {
        reflect += material.transmit;
      } else if (weight * material.transmit >= settings_.min_weight) {
        const Vec3 transmitted = normalized(eta * direction + (eta * cosine - std::sqrt(k)) * n);
        ++counts_.transmitted;
        color += material.transmit *
                 trace({surface.ray_origin(transmitted), transmitted}, depth + 1, weight * material.transmit);
      }
    }
    if (weight * reflect >= settings_.min_weight) {
      const Vec3 mirrored = normalized(direction + 2 * cosine * n);
      ++counts_.reflected;
      color += reflect * trace({surface.ray_origin(mirrored), mirrored}, depth + 1, weight * reflect);
    }
    return color;
  }

  const Scene& scene_;
  const Pose& pose_;
  const RenderSettings& settings_;
  RayCounts& counts_;
};

}  // namespace

Color trace_eye_ray(const Scene& scene, const Pose& pose, const RenderSettings& settings, const Ray& ray,
                    RayCounts& counts) {
  ++counts.primary;
  return LightingTree(scene, pose, settings, counts).trace(ray, 1, 1);
}

}  // namespace rayfarm
