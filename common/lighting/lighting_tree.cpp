#include "common/lighting/lighting_tree.h"

#include "common/math/inline_vector.h"
#include "common/math/portable_math.h"

namespace rayfarm {
namespace {

/// Up to kMostPacketRays rays of one depth are followed together; what becomes of one does not depend on the
/// others.
class LightingTree {
 public:
  LightingTree(const Scene& scene, const Pose& pose, const RenderSettings& settings, RayCounts& counts)
      : scene_(scene), pose_(pose), settings_(settings), counts_(counts) {}

  template <typename T>
  using OfPacket = InlineVector<T, kMostPacketRays>;

  /// `weights`: the largest share that each ray's colour can have in its pixel. Sets `colors`, one per ray.
  void trace(std::span<const Ray> rays, std::span<const double> weights, uint32_t depth, Color* colors) {
    OfPacket<Hit> hits;
    hits.resize_for_overwrite(rays.size());
    closest_hits(scene_, pose_, rays, hits.data());
    OfPacket<Shaded> shaded;
    for (size_t i = 0; i < rays.size(); ++i) {
      if (!hits[i].is_hit()) {
        colors[i] = scene_.head().background;
        continue;
      }
      const Surface surface = eval_surface(scene_, pose_, rays[i], hits[i]);
      const MaterialRecord& material = scene_.materials[surface.material];
      shaded.push_back({surface, &material, rays[i].direction, weights[i], &colors[i],
                        material.ambient * scene_.head().ambient, Color(0)});
    }
    if (shaded.empty()) return;
    add_direct_light(shaded.span());
    if (settings_.lighting == LightingModel::whitted && depth < settings_.max_depth)
      add_secondary_light(shaded.span(), depth);
  }

 private:
  /// A ray that has hit something.
  struct Shaded {
    Surface surface;
    const MaterialRecord* material;
    Vec3 direction;
    double weight;
    Color* color;
    Color diffuse, specular;
  };

  /// A surface that faces a light.
  struct Facing {
    Shaded* shaded;
    Vec3 to_light;
    double cosine_times_distance;
  };

  /// Diffuse and specular terms with a shadow ray to each light in front of the surface.
  void add_direct_light(std::span<Shaded> shaded) {
    for (const LightRecord& light : scene_.lights) {
      OfPacket<Ray> rays;
      OfPacket<Facing> facing;
      for (Shaded& s : shaded) {
        const Vec3 to_light = light.position - s.surface.p;
        const double cosine_times_distance = glm::dot(s.surface.shading_normal, to_light);
        if (!(cosine_times_distance > 0)) continue;
        const Vec3 origin = s.surface.ray_origin(to_light);
        rays.push_back({origin, light.position - origin, 1});
        facing.push_back({&s, to_light, cosine_times_distance});
      }
      if (rays.empty()) continue;
      counts_.shadow += rays.size();
      const uint32_t blocked = any_hits(scene_, pose_, rays.span());
      for (size_t i = 0; i < facing.size(); ++i)
        if (!(blocked >> i & 1)) add_light(facing[i], light);
    }
    for (Shaded& s : shaded) *s.color = s.material->color * s.diffuse + s.specular;
  }

  static void add_light(const Facing& facing, const LightRecord& light) {
    Shaded& s = *facing.shaded;
    const double distance = glm::length(facing.to_light);
    s.diffuse += (s.material->diffuse * (facing.cosine_times_distance / distance)) * light.color;
    if (!(s.material->specular > 0)) return;
    const Vec3& n = s.surface.shading_normal;
    const Vec3 reflected = s.direction - 2 * glm::dot(s.direction, n) * n;
    const double cosine = glm::dot(reflected, facing.to_light) / distance;
    if (cosine > 0)
      s.specular += (s.material->specular * portable_pow(cosine, s.material->shininess)) * light.color;
  }

  /// Rays that shaded surfaces spawn, with the share of its colour that each takes.
  struct Branches {
    OfPacket<Ray> rays;
    OfPacket<double> weights, shares;
    OfPacket<Color*> parents;

    void add(const Shaded& parent, const Vec3& direction, double share) {
      rays.push_back({parent.surface.ray_origin(direction), direction});
      weights.push_back(parent.weight * share);
      shares.push_back(share);
      parents.push_back(parent.color);
    }
  };

  /// Reflected and transmitted terms. A surface that transmits also spawns a reflected ray, even one of
  /// weight 0 if there is no cut-off: that is how published ray counts were made. Total internal reflection
  /// sends the transmitted share along the mirror direction.
  void add_secondary_light(std::span<const Shaded> shaded, uint32_t depth) {
    Branches transmitted, reflected;
    for (const Shaded& s : shaded) {
      const MaterialRecord& material = *s.material;
      if (!(material.reflect > 0 || material.transmit > 0)) continue;
      // A shading normal that faces away, at a silhouette, has no mirror direction: the surface's own normal
      // has.
      Vec3 n = s.surface.shading_normal;
      if (!(glm::dot(s.direction, n) < 0)) n = s.surface.geometric_normal;
      const double cosine = -glm::dot(s.direction, n);
      double reflect = material.reflect;
      if (material.transmit > 0) {
        // Snell: with eta the ratio of the indices outside and inside of the new side.
        const double eta = s.surface.is_front ? 1 / material.index : material.index;
        const double k = 1 - eta * eta * (1 - cosine * cosine);
        if (k < 0)
          reflect += material.transmit;
        else if (s.weight * material.transmit >= settings_.min_weight)
          transmitted.add(s, normalized(eta * s.direction + (eta * cosine - std::sqrt(k)) * n),
                          material.transmit);
      }
      if (s.weight * reflect >= settings_.min_weight)
        reflected.add(s, normalized(s.direction + 2 * cosine * n), reflect);
    }
    counts_.transmitted += transmitted.rays.size();
    follow(transmitted, depth);
    counts_.reflected += reflected.rays.size();
    follow(reflected, depth);
  }

  void follow(const Branches& branches, uint32_t depth) {
    if (branches.rays.empty()) return;
    OfPacket<Color> colors;
    colors.resize_for_overwrite(branches.rays.size());
    trace(branches.rays.span(), branches.weights.span(), depth + 1, colors.data());
    for (size_t i = 0; i < colors.size(); ++i) *branches.parents[i] += branches.shares[i] * colors[i];
  }

  const Scene& scene_;
  const Pose& pose_;
  const RenderSettings& settings_;
  RayCounts& counts_;
};

}  // namespace

void trace_eye_rays(const Scene& scene, const Pose& pose, const RenderSettings& settings,
                    std::span<const Ray> rays, RayCounts& counts, Color* colors) {
  counts.primary += rays.size();
  std::array<double, kMostPacketRays> whole;
  whole.fill(1);
  LightingTree(scene, pose, settings, counts).trace(rays, std::span(whole).first(rays.size()), 1, colors);
}

}  // namespace rayfarm
