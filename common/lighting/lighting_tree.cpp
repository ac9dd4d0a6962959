#include "common/lighting/lighting_tree.h"

#include "common/math/portable_math.h"

namespace rayfarm {
namespace {

/// Up to kMostPacketRays rays of one depth are followed together; what becomes of one does not depend on the
/// others.
class LightingTree {
 public:
  LightingTree(const Scene& scene, const Pose& pose, const RenderSettings& settings, RayCounts& counts)
      : scene_(scene), pose_(pose), settings_(settings), counts_(counts) {}

  /// What a ray adds to: `weight` is the largest share that its colour can have in the pixel.
  struct Branches {
    std::array<Ray, kMostPacketRays> rays;
    std::array<double, kMostPacketRays> weights;
    size_t count = 0;
    std::span<const Ray> span() const { return std::span(rays).first(count); }
  };

  void trace(const Branches& branches, uint32_t depth, Color* colors) {
    std::array<Hit, kMostPacketRays> hits;
    closest_hits(scene_, pose_, branches.span(), hits.data());
    std::array<Shaded, kMostPacketRays> shaded;
    size_t count = 0;
    for (size_t i = 0; i < branches.count; ++i) {
      if (!hits[i].is_hit()) {
        colors[i] = scene_.head().background;
        continue;
      }
      Shaded& s = shaded[count++];
      s.surface = eval_surface(scene_, pose_, branches.rays[i], hits[i]);
      s.material = &scene_.materials[s.surface.material];
      s.direction = branches.rays[i].direction;
      s.weight = branches.weights[i];
      s.color = &colors[i];
    }
    if (count == 0) return;
    add_direct_light(std::span(shaded).first(count));
    if (settings_.lighting == LightingModel::whitted && depth < settings_.max_depth)
      add_secondary_light(std::span(shaded).first(count), depth);
  }

 private:
  /// A ray that has hit something.
  struct Shaded {
    Surface surface;
    const MaterialRecord* material = nullptr;
    Vec3 direction{0};
    double weight = 0;
    Color* color = nullptr;
    Color diffuse{0}, specular{0};
    double transmit = 0, reflect = 0;
  };

  /// Ambient, diffuse and specular terms with a shadow ray to each light in front of the surface.
  void add_direct_light(std::span<Shaded> shaded) {
    for (Shaded& s : shaded) s.diffuse = s.material->ambient * scene_.head().ambient;
    for (const LightRecord& light : scene_.lights) {
      std::array<Ray, kMostPacketRays> rays;
      std::array<Shaded*, kMostPacketRays> facing;
      size_t count = 0;
      for (Shaded& s : shaded) {
        const Vec3 to_light = light.position - s.surface.p;
        if (!(glm::dot(s.surface.shading_normal, to_light) > 0)) continue;
        const Vec3 origin = s.surface.ray_origin(to_light);
        rays[count] = {origin, light.position - origin, 1};
        facing[count++] = &s;
      }
      if (count == 0) continue;
      counts_.shadow += count;
      const uint32_t blocked = any_hits(scene_, pose_, std::span(rays).first(count));
      for (size_t i = 0; i < count; ++i)
        if (!(blocked >> i & 1)) add_light(*facing[i], light);
    }
    for (Shaded& s : shaded) *s.color = s.material->color * s.diffuse + s.specular;
  }

  static void add_light(Shaded& s, const LightRecord& light) {
    const Vec3& n = s.surface.shading_normal;
    const Vec3 to_light = light.position - s.surface.p;
    const double distance = glm::length(to_light);
    s.diffuse += (s.material->diffuse * (glm::dot(n, to_light) / distance)) * light.color;
    if (!(s.material->specular > 0)) return;
    const Vec3 reflected = s.direction - 2 * glm::dot(s.direction, n) * n;
    const double cosine = glm::dot(reflected, to_light) / distance;
    if (cosine > 0)
      s.specular += (s.material->specular * portable_pow(cosine, s.material->shininess)) * light.color;
  }

  /// Reflected and transmitted terms. A surface that transmits also spawns a reflected ray, even one of
  /// weight 0 if there is no cut-off: that is how published ray counts were made. Total internal reflection
  /// sends the transmitted share along the mirror direction.
  void add_secondary_light(std::span<Shaded> shaded, uint32_t depth) {
    Branches transmitted, reflected;
    std::array<Shaded*, kMostPacketRays> of_transmitted, of_reflected;
    for (Shaded& s : shaded) {
      const MaterialRecord& material = *s.material;
      if (!(material.reflect > 0 || material.transmit > 0)) continue;
      // A shading normal that faces away, at a silhouette, has no mirror direction: the surface's own normal
      // has.
      Vec3 n = s.surface.shading_normal;
      if (!(glm::dot(s.direction, n) < 0)) n = s.surface.geometric_normal;
      const double cosine = -glm::dot(s.direction, n);
      s.reflect = material.reflect;
      s.transmit = material.transmit;
      if (material.transmit > 0) {
        // Snell: with eta the ratio of the indices outside and inside of the new side.
        const double eta = s.surface.is_front ? 1 / material.index : material.index;
        const double k = 1 - eta * eta * (1 - cosine * cosine);
        if (k < 0) {
          s.reflect += material.transmit;
        } else if (s.weight * material.transmit >= settings_.min_weight) {
          const Vec3 direction = normalized(eta * s.direction + (eta * cosine - std::sqrt(k)) * n);
          add_branch(transmitted, of_transmitted, s, direction, s.transmit);
        }
      }
      if (s.weight * s.reflect >= settings_.min_weight)
        add_branch(reflected, of_reflected, s, normalized(s.direction + 2 * cosine * n), s.reflect);
    }
    std::array<Color, kMostPacketRays> colors;
    if (transmitted.count > 0) {
      counts_.transmitted += transmitted.count;
      trace(transmitted, depth + 1, colors.data());
      for (size_t i = 0; i < transmitted.count; ++i)
        *of_transmitted[i]->color += of_transmitted[i]->transmit * colors[i];
    }
    if (reflected.count > 0) {
      counts_.reflected += reflected.count;
      trace(reflected, depth + 1, colors.data());
      for (size_t i = 0; i < reflected.count; ++i)
        *of_reflected[i]->color += of_reflected[i]->reflect * colors[i];
    }
  }

  static void add_branch(Branches& branches, std::array<Shaded*, kMostPacketRays>& parents, Shaded& parent,
                         const Vec3& direction, double share) {
    branches.rays[branches.count] = {parent.surface.ray_origin(direction), direction};
    branches.weights[branches.count] = parent.weight * share;
    parents[branches.count++] = &parent;
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
  LightingTree::Branches branches;
  std::copy(rays.begin(), rays.end(), branches.rays.begin());
  branches.weights.fill(1);
  branches.count = rays.size();
  LightingTree(scene, pose, settings, counts).trace(branches, 1, colors);
}

}  // namespace rayfarm
