#include "common/lighting/lighting_tree.h"

#include <numbers>

#include "common/lighting/environment.h"
#include "common/lighting/path_tracer.h"
#include "common/lighting/textured.h"
#include "common/lighting/torrance_sparrow.h"
#include "common/math/inline_vector.h"
#include "common/math/portable_math.h"

namespace rayfarm {
namespace {

template <typename T>
using OfPacket = InlineVector<T, kMostPacketRays>;

/// Diffuse rays that are no farther apart than 60 degrees are neighbours.
constexpr double kLeastNeighborCosine = 0.5;

/// Where a ray stands in its lighting tree.
struct Branch {
  double weight = 1;  ///< the largest share that the ray's colour can have in its pixel
  SampleId id;
  uint32_t stream = 0;           ///< tells the branches of one sample apart, for their random numbers
  double width = 0, spread = 0;  ///< of the ray's cone where it begins, and what it gains with each unit
  bool is_diffuse = false;       ///< a diffuse ray of the thesis's model
  Color* as_diffuse =
      nullptr;  ///< where to set what a diffuse ray would bring, if this one serves as such, too
};

/// Up to kMostPacketRays rays of one depth are followed together; what becomes of one does not depend on the
/// others.
class LightingTree {
 public:
  LightingTree(const FrameContext& context, RayCounts& counts)
      : tables_(context.tables),
        scene_(context.scene),
        pose_(context.pose),
        settings_(context.tables.settings),
        counts_(counts),
        has_secondary_(settings_.lighting == LightingModel::whitted ||
                       settings_.lighting == LightingModel::thesis),
        is_thesis_(settings_.lighting == LightingModel::thesis) {}

  /// Sets `colors`, one per ray. Returns how many rays met an object.
  size_t trace(std::span<const Ray> rays, std::span<const Branch> branches, uint32_t depth, Color* colors) {
    OfPacket<Hit> hits;
    hits.resize_for_overwrite(rays.size());
    closest_hits(scene_, pose_, rays, hits.data());
    OfPacket<Shaded> shaded;
    for (size_t i = 0; i < rays.size(); ++i) {
      if (is_thesis_ && branches[i].as_diffuse) *branches[i].as_diffuse = Color(0);
      if (!hits[i].is_hit()) {
        colors[i] = eval_background(scene_, rays[i].direction);
        continue;
      }
      Surface surface = eval_surface(scene_, pose_, rays[i], hits[i]);
      const Material& material = scene_.materials[surface.material];
      const double width = branches[i].width + hits[i].t * branches[i].spread;
      const Color color = is_textured(material)
                              ? textured(scene_, pose_, rays[i], hits[i], material, width, surface).color
                              : material.color;
      // Rays stand in for ambient light in the thesis's model.
      const Color ambient = is_thesis_ ? Color(0) : material.ambient * scene_.head().ambient;
      Shaded& s = shaded.push_back(
          {surface, &material, color, rays[i].direction, branches[i], &colors[i], ambient, Color(0)});
      s.branch.width = width;
      if (is_luminaire(material)) add_emission(s, hits[i]);
      if (branches[i].is_diffuse) s.branch.weight *= strength(hits[i].t);
    }
    if (!shaded.empty()) add_direct_light(shaded.span());
    if (has_secondary_ && depth < settings_.max_depth) add_secondary_light(shaded.span(), depth);
    for (size_t i = 0; is_thesis_ && i < rays.size(); ++i) {
      if (branches[i].is_diffuse) colors[i] = weakened(colors[i], hits[i]);
      if (branches[i].as_diffuse)
        *branches[i].as_diffuse = weakened(colors[i] - *branches[i].as_diffuse, hits[i]);
    }
    return shaded.size();
  }

 private:
  /// A ray that has hit something.
  struct Shaded {
    Surface surface;
    const Material* material;
    Color surface_color;  ///< the material's, textured
    Vec3 direction;
    Branch branch;
    Color* color;
    Color diffuse, specular;
  };

  /// A surface that faces a light.
  struct Facing {
    Shaded* shaded;
    Vec3 to_light;
    double cosine_times_distance;
    Color light;  ///< what a white surface that faces the light shows
    bool has_highlight;
  };

  /// How much of its light a diffuse ray of this length brings (thesis 3.2).
  double strength(double distance) const {
    if (!(settings_.diffuse_reach > 0)) return 1;
    const double ratio = distance / settings_.diffuse_reach;
    return 1 / (1 + ratio * ratio);
  }

  /// What a diffuse ray brings of the light that it met: ambient light stands in for what is lost.
  Color weakened(const Color& color, const Hit& hit) const {
    if (!(settings_.diffuse_reach > 0)) return color;
    const double s = hit.is_hit() ? strength(hit.t) : 0;
    return s * color + (1 - s) * scene_.head().ambient;
  }

  /// A primary source that shadow rays are sent to must not be counted again when a diffuse ray meets it.
  void add_emission(Shaded& s, const Hit& hit) const {
    const bool counts_once = s.branch.is_diffuse || s.branch.as_diffuse;
    const bool is_primary = counts_once && find_luminaire(scene_, hit.instance, hit.primitive) != kNone;
    if (s.branch.is_diffuse && is_primary) return;
    const Color light = emitted(*s.material, interaction_at(s.surface, s.direction, *s.material));
    s.specular += light;
    if (s.branch.as_diffuse && is_primary) *s.branch.as_diffuse = light;
  }

  /// Diffuse and specular terms with a shadow ray to each light in front of the surface.
  void add_direct_light(std::span<Shaded> shaded) {
    for (uint32_t i = 0; i < scene_.lights.size(); ++i) {
      const Light& light = scene_.lights[i];
      if (light.kind == LightKind::environment)
        continue;  // diffuse rays meet it, or ambient light stands for it
      OfPacket<Ray> rays;
      OfPacket<Facing> facing;
      for (Shaded& s : shaded) {
        const bool has_highlight = !is_mirrored_in(*s.material, light);
        if (!has_highlight && !(s.material->diffuse > 0)) continue;
        Vec3 target = light.position;
        Facing f{&s, target - s.surface.p, 0, light.color, has_highlight};
        if (light.kind != LightKind::point) {
          const LightSample sample = sample_light(scene_, pose_, light, s.surface.p, light_point(s, i));
          target = sample.target;
          f.to_light = sample.to_light;
          f.light = sample.incident / std::numbers::pi;
        }
        f.cosine_times_distance = glm::dot(s.surface.shading_normal, f.to_light);
        if (!(f.cosine_times_distance > 0)) continue;
        const Vec3 origin = s.surface.ray_origin(f.to_light);
        rays.push_back({origin, target - origin, 1});
        facing.push_back(f);
      }
      if (rays.empty()) continue;
      counts_[RayKind::shadow] += rays.size();
      const uint32_t blocked = any_hits(scene_, pose_, rays.span());
      for (size_t k = 0; k < facing.size(); ++k)
        if (!(blocked >> k & 1)) add_light(facing[k]);
    }
    for (Shaded& s : shaded) *s.color = s.surface_color * s.diffuse + s.specular;
  }

  /// A reflected ray shows a luminous body itself; a highlight would count it again.
  bool is_mirrored_in(const Material& material, const Light& light) const {
    return has_extent(light) && has_secondary_ && material.reflect > 0;
  }

  Vec2 light_point(const Shaded& s, uint32_t light) const {
    if (!has_extent(scene_.lights[light])) return Vec2(0);
    const auto stream = static_cast<uint32_t>(mix_bits(uint64_t{s.branch.stream} << 32 | light));
    return tables_.sampler.point(s.branch.id, stream << 8 | dimension::kLightPoint);
  }

  void add_light(const Facing& facing) const {
    Shaded& s = *facing.shaded;
    const double distance = glm::length(facing.to_light);
    s.diffuse += (s.material->diffuse * (facing.cosine_times_distance / distance)) * facing.light;
    if (!facing.has_highlight || !(s.material->specular > 0)) return;
    const Vec3& n = s.surface.shading_normal;
    if (settings_.lighting == LightingModel::torrance_sparrow) {
      s.specular += facet_highlight(*s.material, n, facing.to_light / distance, -s.direction) * facing.light;
      return;
    }
    const Vec3 reflected = s.direction - 2 * glm::dot(s.direction, n) * n;
    const double cosine = glm::dot(reflected, facing.to_light) / distance;
    if (cosine > 0)
      s.specular += (s.material->specular * portable_pow(cosine, s.material->shininess)) * facing.light;
  }

  /// Rays that leave surfaces, each with the weight of its colour there.
  struct Branches {
    OfPacket<Ray> rays;
    OfPacket<Branch> branches;
    OfPacket<Color> shares;
    OfPacket<Color*> parents;
    Branch& add(const Shaded& parent, const Vec3& direction, const Color& share, uint32_t child) {
      rays.push_back({parent.surface.ray_origin(direction), direction});
      shares.push_back(share);
      parents.push_back(parent.color);
      Branch& branch = branches.push_back(parent.branch);
      branch.weight *= max_component(share);
      branch.stream = static_cast<uint32_t>(mix_bits(uint64_t{branch.stream} << 32 | child));
      branch.is_diffuse = false;
      branch.as_diffuse = nullptr;
      return branch;
    }
  };
  enum Child : uint32_t { kTransmitted = 1, kReflected, kFirstDiffuse };

  /// Reflected and transmitted terms. A surface that transmits also spawns a reflected ray, even one of
  /// weight 0 if there is no cut-off: that is how published ray counts were made. Total internal reflection
  /// sends the transmitted share along the mirror direction.
  void add_secondary_light(std::span<const Shaded> shaded, uint32_t depth) {
    Branches transmitted, reflected;
    for (const Shaded& s : shaded) {
      const Material& material = *s.material;
      const bool has_diffuse = is_thesis_ && material.diffuse > 0;
      const bool has_mirror = material.reflect > 0 || material.transmit > 0;
      if (!has_mirror && !has_diffuse) continue;
      const Interaction at = interaction_at(s.surface, s.direction, material);
      double reflect = material.reflect;
      if (material.transmit > 0) {
        const Vec3 through = refracted(at);
        if (through == Vec3(0))
          reflect += material.transmit;
        else if (s.branch.weight * material.transmit >= settings_.min_weight)
          transmitted.add(s, through, Color(material.transmit), kTransmitted);
      }
      const bool is_mirrored = has_mirror && s.branch.weight * reflect >= settings_.min_weight;
      const Vec3 mirror = is_mirrored ? mirrored(at) : Vec3(0);
      if (has_diffuse && add_diffuse_light(s, depth, mirror, reflect)) continue;
      if (is_mirrored) reflected.add(s, mirror, Color(reflect), kReflected);
    }
    counts_[RayKind::transmitted] += transmitted.rays.size();
    follow(transmitted, depth);
    counts_[RayKind::reflected] += reflected.rays.size();
    follow(reflected, depth);
  }

  void follow(const Branches& branches, uint32_t depth) {
    if (branches.rays.empty()) return;
    OfPacket<Color> colors;
    colors.resize_for_overwrite(branches.rays.size());
    trace(branches.rays.span(), branches.branches.span(), depth + 1, colors.data());
    for (size_t i = 0; i < colors.size(); ++i) *branches.parents[i] += branches.shares[i] * colors[i];
  }

  /// A diffuse ray and what it brought.
  struct Gathered {
    Vec3 direction{0};
    Color color{0};
  };

  /// Light from secondary sources (Equation 3.6a, second term): this sample's part of the pixel's directions,
  /// and one more between neighbours that differ (3.3). A reflected ray along `mirror` (0: there is none)
  /// that falls into a diffuse ray's own cone serves both terms (3.4); then its reflected light is added,
  /// too, and the answer is true.
  bool add_diffuse_light(const Shaded& s, uint32_t depth, const Vec3& mirror, double reflect) {
    const auto directions = tables_.diffuse_directions.about_y();
    const auto samples = static_cast<uint32_t>(samples_that_share_directions(settings_));
    const Color share = (s.material->diffuse / settings_.diffuse_rays) * s.surface_color;
    if (!(s.branch.weight * max_component(share) >= settings_.min_weight) || max_component(share) == 0)
      return false;
    // One turn for all samples of a pixel keeps the set together; each takes a part of it, in random order.
    SampleId pixel = s.branch.id;
    uint32_t sample = pixel.sample;
    if (settings_.sampling == SamplingPattern::corners) {
      sample = static_cast<uint32_t>((pixel.x & 1) + 2 * (pixel.y & 1));
      pixel.x &= ~1;
      pixel.y &= ~1;
    }
    pixel.sample = 0;
    const auto r = random_pair(settings_.seed, tables_.sampler.frame(), pixel,
                               s.branch.stream << 8 | dimension::kPattern);
    const double turn = 2 * std::numbers::pi * r[0];
    const uint32_t part = permuted(sample, samples, static_cast<uint64_t>(r[1] * 0x1p53));
    // Of n rays each stands for 2π / n of the hemisphere: a cap of this cosine.
    const double cosine_of_cone = 1 - 1 / static_cast<double>(directions.size());

    bool serves_both = false;
    Color sum(0);
    Gathered last;
    for (uint32_t begin = 0; begin < settings_.diffuse_rays; begin += kMostPacketRays) {
      const uint32_t end = std::min<uint32_t>(begin + kMostPacketRays, settings_.diffuse_rays);
      Branches branches;
      std::array<Color, kMostPacketRays> colors, as_diffuse;
      size_t both = kMostPacketRays;  // which of the rays serves both terms
      for (uint32_t i = begin; i < end; ++i) {
        const size_t ray = part + size_t{i} * samples;
        const Vec3 about_y = settings_.diffuse_jitter ? jittered(s, ray, kFirstDiffuse + i) : directions[ray];
        const Vec3 direction = rotated_to(s.surface.shading_normal, about_y, turn);
        if (!serves_both && glm::dot(direction, mirror) > cosine_of_cone) {
          serves_both = true;
          both = i - begin;
          branches.add(s, mirror, share + reflect, kReflected).as_diffuse = &as_diffuse[both];
          ++counts_[RayKind::reflected];
        } else {
          add_diffuse(branches, s, direction, share, kFirstDiffuse + i);
        }
      }
      trace(branches.rays.span(), branches.branches.span(), depth + 1, colors.data());
      for (size_t k = 0; k < branches.rays.size(); ++k) {
        if (k == both) {
          *s.color += reflect * colors[k];
          colors[k] = as_diffuse[k];
        }
        const Gathered now{branches.rays[k].direction, colors[k]};
        sum += now.color;
        if (settings_.diffuse_contrast > 0 && begin + k > 0)
          sum += between(s, last, now, share, begin + static_cast<uint32_t>(k), depth);
        last = now;
      }
    }
    *s.color += share * sum;
    return serves_both;
  }

  Vec3 jittered(const Shaded& s, size_t ray, uint32_t child) const {
    const auto stream = static_cast<uint32_t>(mix_bits(uint64_t{s.branch.stream} << 32 | child));
    const auto r = random_pair(settings_.seed, tables_.sampler.frame(), s.branch.id,
                               stream << 8 | dimension::kDirection);
    return tables_.diffuse_directions.jittered(ray, {r[0], r[1]});
  }

  void add_diffuse(Branches& branches, const Shaded& s, const Vec3& direction, const Color& share,
                   uint32_t child) {
    Branch& branch = branches.add(s, direction, share, child);
    branch.is_diffuse = true;
    branch.spread = kDiffuseSpread;
    ++counts_[RayKind::diffuse];
  }

  /// What one more ray between two neighbours that differ adds to the sum: (a + b) / 2, what the two see of
  /// the gap between them, becomes (a + 2 e + b) / 4.
  Color between(const Shaded& s, const Gathered& a, const Gathered& b, const Color& share, uint32_t ray,
                uint32_t depth) {
    if (!(glm::dot(a.direction, b.direction) > kLeastNeighborCosine)) return Color(0);
    if (!(s.branch.weight * max_magnitude(share * (a.color - b.color)) > settings_.diffuse_contrast))
      return Color(0);
    Branches branches;
    add_diffuse(branches, s, normalized(a.direction + b.direction), share,
                kFirstDiffuse + settings_.diffuse_rays + ray);
    Color extra;
    trace(branches.rays.span(), branches.branches.span(), depth + 1, &extra);
    return 0.25 * (2.0 * extra - a.color - b.color);
  }

  const SamplingTables& tables_;
  const Scene& scene_;
  const Pose& pose_;
  const RenderSettings& settings_;
  RayCounts& counts_;
  bool has_secondary_, is_thesis_;
};

}  // namespace

size_t trace_eye_rays(const FrameContext& context, std::span<const Ray> rays, std::span<const SampleId> ids,
                      RayCounts& counts, Color* colors) {
  counts[RayKind::primary] += rays.size();
  if (context.tables.settings.lighting == LightingModel::path)
    return trace_paths(context, rays, ids, counts, colors);
  OfPacket<Branch> branches;
  for (const SampleId& id : ids) {
    Branch& branch = branches.push_back({});
    branch.id = id;
    branch.spread = context.spread;
  }
  return LightingTree(context, counts).trace(rays, branches.span(), 1, colors);
}

}  // namespace rayfarm
