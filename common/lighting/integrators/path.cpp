// The rendering equation without bias: paths that scatter as the materials do, a shadow ray to one source at
// each turn, both weighted by multiple importance sampling (Veach 1997), ended by Russian roulette. The
// reference for the other lighting models. Ambient light, their stand-in for what paths find, is left out.
#include <bit>

#include "common/lighting/environment.h"
#include "common/lighting/integrators/integrator.h"
#include "common/lighting/integrators/path_step.h"
#include "common/lighting/item_buffers.h"
#include "common/lighting/light_choice.h"
#include "common/lighting/light_sampling.h"
#include "common/lighting/self_hits.h"
#include "common/lighting/textured.h"

namespace rayfarm {
namespace {

/// From this depth on paths end by chance.
constexpr uint32_t kFirstRoulette = 4;

/// A path on its way.
struct Path {
  Color throughput{1};
  uint32_t place = 0;  ///< of its eye ray, whose colour it adds to
  SampleId id;
  Media media;
  double pdf = 0;  ///< of the last direction; 0: only chance could have led here, as along a mirror's
  double width = 0, spread = 0;  ///< of the ray's cone
  uint32_t depth = 1, reflections = 0, transmissions = 0;
};
static_assert(std::is_trivially_copyable_v<Path>);

/// Up to kMostPacketRays paths go on together; what becomes of one does not depend on the others. Those whose
/// surfaces allow it take their steps in lanes at once, the others one by one, and no bit of a colour tells
/// which.
class PathTracer {
 public:
  PathTracer(const FrameContext& context, bool is_in_lanes, RayCounts& counts, Color* colors)
      : context_(context),
        scene_(context.scene),
        pose_(context.pose),
        settings_(context.tables.settings),
        sampler_(context.tables.sampler),
        is_in_lanes_(is_in_lanes),
        is_by_medium_(is_by_medium(context)),
        counts_(counts),
        colors_(colors) {}

  /// Returns how many rays met an object.
  size_t trace(const RayPacket& rays, std::span<const SampleId> ids) {
    ids_ = ids;
    lanes_.rays = rays;
    for (size_t i = 0; i < rays.size; ++i) {
      colors_[i] = Color(0);
      Path& path = paths_.emplace_back();
      path.place = static_cast<uint32_t>(i);
      path.id = ids[i];
      path.spread = context_.spread;
      if (context_.eye_media) [[unlikely]]
        path.media = *context_.eye_media;
      lanes_.places[i] = path.place;
      lanes_.pixel_keys[i] = sampler_.pixel_key(ids[i]);
      lanes_.reversed_samples[i] = reversed_bits(ids[i].sample);
      set_lane(lanes_.throughput, i, path.throughput);
      lanes_.pdf[i] = path.pdf;
    }
    for (; !lanes_.rays.empty(); ++depth_) step();
    return eye_hits_;
  }

 private:
  void step() {
    const size_t count = lanes_.rays.size;
    OfPacket<Hit> hits;
    hits.resize_for_overwrite(count);
    counts_[RayTally::tree_depth] += count;
    if (depth_ == 1)
      find_eye_hits(context_, lanes_.rays, hits.data());
    else
      closest_hits(scene_, pose_, lanes_.rays, hits.data());
    if (is_by_medium_) [[unlikely]]
      keep_real(hits.data());
    lanes_.clear_sets();
    shadows_.rays.clear();
    LaneSet together = 0, go_on = 0;
    if (is_in_lanes_) {
      LaneSet met = eval_surfaces(scene_, pose_, lanes_.rays, hits.data(), lanes_.surfaces);
      if (is_by_medium_) [[unlikely]]
        lay_on_surfaces(scene_, met, lanes_.surfaces);
      if (depth_ >= settings_.max_depth) met = 0;
      for_each_lane(met, [&](size_t lane) {
        if (prepare(lane, hits[lane])) together |= LaneSet{1} << lane;
      });
    }
    if (together != 0) go_on = visit_together(together);
    for (size_t lane = 0; lane < count; ++lane)
      if (!(together >> lane & 1) && visit_alone(lane, hits[lane])) go_on |= LaneSet{1} << lane;
    lanes_.keep(go_on);
    if (shadows_.rays.empty()) return;
    counts_[RayKind::shadow] += shadows_.rays.size;
    const uint32_t blocked = is_by_medium_ ? find_really_blocked() : any_hits(scene_, pose_, shadows_.rays);
    for (size_t i = 0; i < shadows_.rays.size; ++i)
      if (!(blocked >> i & 1)) colors_[shadows_.places[i]] += lane_of(shadows_.colors, i);
  }

  /// Rays know what they are in, and so do the shadow rays of this step.
  [[gnu::noinline]] void keep_real(Hit* hits) {
    MediaOfRays media{};
    for (size_t lane = 0; lane < lanes_.rays.size; ++lane) {
      const uint32_t place = lanes_.places[lane];
      media[lane] = &paths_[place].media;
      shadow_media_[place] = paths_[place].media;
    }
    keep_real_hits(context_, lanes_.rays, media, hits);
  }

  [[gnu::noinline]] uint32_t find_really_blocked() const {
    MediaOfRays media{};
    for (size_t i = 0; i < shadows_.rays.size; ++i) media[i] = &shadow_media_[shadows_.places[i]];
    return any_real_hits(context_, shadows_.rays, media, shadows_.rays.all());
  }

  /// A path's step by itself.
  bool visit_alone(size_t lane, const Hit& hit) {
    Path& path = paths_[lanes_.places[lane]];
    path.depth = depth_;
    path.throughput = lane_of(lanes_.throughput, lane);
    path.pdf = lanes_.pdf[lane];
    Ray ray = lanes_.rays[lane];
    Surface surface;
    if (hit.is_hit()) surface = is_in_lanes_ ? lanes_.surfaces[lane] : eval_surface(scene_, pose_, ray, hit);
    if (is_by_medium_ && hit.is_hit()) [[unlikely]]
      surface = laid_on_surface(scene_, surface);
    if (!visit(path, ray, hit, surface)) return false;
    set_lane(lanes_.throughput, lane, path.throughput);
    lanes_.pdf[lane] = path.pdf;
    lanes_.rays.set(lane, ray.origin, ray.direction);
    return true;
  }

  /// Sets what a step in lanes needs. False if the path must go alone: nothing has happened to it then.
  bool prepare(size_t lane, const Hit& hit) {
    Path& path = paths_[lanes_.places[lane]];
    if (!lanes_.set_material(scene_, lane, path.media)) return false;
    const LaneSet bit = LaneSet{1} << lane;
    if (path.reflections < settings_.max_reflections) lanes_.can_reflect |= bit;
    if (path.transmissions < settings_.max_transmissions) lanes_.can_transmit |= bit;
    if (depth_ == 1) ++eye_hits_;
    path.width += hit.t * path.spread;
    if (!path.media.is_in_air())
      set_lane(lanes_.throughput, lane,
               lane_of(lanes_.throughput, lane) * path.media.transmittance(scene_, hit.t));
    return true;
  }

  /// The steps of the lanes that are prepared. Returns those whose paths go on.
  LaneSet visit_together(LaneSet lanes) {
    const PathStep step =
        step_in_lanes({context_, ids_, depth_, depth_ >= kFirstRoulette}, lanes, lanes_, shadows_);
    for_each_lane(step.go_on, [&](size_t lane) {
      Path& path = paths_[lanes_.places[lane]];
      if (step.is_diffuse >> lane & 1) path.spread = kDiffuseSpread;
      const bool is_transmitted = step.is_transmitted >> lane & 1;
      ++(is_transmitted ? path.transmissions : path.reflections);
      if (is_transmitted && (is_by_medium_ || (lanes_.dielectrics >> lane & 1)))
        path.media.cross(lanes_.surfaces.material[lane], lanes_.surfaces.is_front(lane));
    });
    const auto count = [](LaneSet set) { return static_cast<size_t>(std::popcount(set)); };
    counts_[RayKind::transmitted] += count(step.is_transmitted);
    counts_[RayKind::diffuse] += count(step.is_diffuse);
    counts_[RayKind::reflected] += count(step.go_on & ~(step.is_transmitted | step.is_diffuse));
    return step.go_on;
  }

  /// Adds what the path finds where it hits, and turns `ray` into what follows. False: the path ends.
  bool visit(Path& path, Ray& ray, const Hit& hit, Surface& surface) {
    if (!hit.is_hit()) {
      Color light = path.throughput * eval_background(scene_, ray.direction);
      if (path.pdf > 0 && scene_.head().environment != kNone)
        light *= balance(path.pdf, choice_probability(scene_, environment_source(scene_)) *
                                       environment_pdf(scene_, ray.direction));
      colors_[path.place] += light;
      return false;
    }
    if (path.depth == 1) ++eye_hits_;
    path.width += hit.t * path.spread;
    Material with_texture;
    const Material* chosen = &scene_.materials[surface.material];
    if (is_textured(*chosen)) {
      const double choice = chosen->kind == MaterialKind::mix
                                ? sampler_.point(path.id, dimension::of_mix(path.depth << 8)).x
                                : 0;
      with_texture = textured(scene_, pose_, ray, hit, path.width, choice, surface);
      chosen = &with_texture;
    }
    const Material& material = *chosen;
    if (!path.media.is_in_air()) path.throughput *= path.media.transmittance(scene_, hit.t);

    Interaction at = interaction_at(surface, ray.direction, material);
    const bool is_dielectric = material.kind == MaterialKind::dielectric;
    if (is_dielectric) {
      const Media::Crossing crossing = path.media.meet(scene_, surface.material, surface.is_front);
      if (!crossing.is_real) {
        path.media.cross(surface.material, surface.is_front);
        path.pdf = 0;  // no shadow ray could have come through
        ray = {surface.ray_origin(ray.direction), ray.direction};
        return ++path.depth <= settings_.max_depth;
      }
      at.index_ratio = crossing.index_ratio;
    }
    add_emission(path, ray, hit, surface, material, at);
    if (path.depth >= settings_.max_depth) return false;

    Lobes lobes;
    scatter(material, at, lobes);
    keep_allowed(path, lobes);
    if (has_diffuse_rays(material)) {
      add_direct_light(path, surface, at, lobes, lobes);
    } else {
      Lobes followed;
      for (const Lobe& lobe : lobes)
        if (is_followed(material, lobe)) followed.push_back(lobe);
      add_direct_light(path, surface, at, lobes, followed);
      lobes = followed;
    }
    // Points are made only where they are asked for.
    const bool is_risky = path.depth >= kFirstRoulette;
    const Vec2 lobe = lobes.size() > 1 || is_risky ? point(path, dimension::kLobe) : Vec2(0);
    const ScatteredRay next = sample(lobes, at, point(path, dimension::kDirection), lobe.x);
    path.throughput *= next.weight;
    path.pdf = next.pdf;
    if (next.spread == Lobe::Spread::diffuse) path.spread = kDiffuseSpread;
    if ((glm::dot(surface.geometric_normal, next.direction) > 0) == next.is_transmitted) return false;
    if (!survives(path, is_risky ? lobe.y : 0)) return false;
    if (is_by_medium_) [[unlikely]]
      leave(scene_, surface, next.direction, path.media);
    else if (next.is_transmitted && is_dielectric)
      path.media.cross(surface.material, surface.is_front);
    ++path.depth;
    ++(next.is_transmitted ? path.transmissions : path.reflections);
    ++(next.is_transmitted                    ? counts_[RayKind::transmitted]
       : next.spread == Lobe::Spread::diffuse ? counts_[RayKind::diffuse]
                                              : counts_[RayKind::reflected]);
    ray = {surface.ray_origin(next.direction), next.direction};
    return true;
  }

  /// Light that has been reflected or transmitted as often as is allowed goes on by the other lobes alone. So
  /// what a shadow ray finds is limited as what the path itself finds.
  void keep_allowed(const Path& path, Lobes& lobes) const {
    const bool reflects = path.reflections < settings_.max_reflections,
               transmits = path.transmissions < settings_.max_transmissions;
    if (reflects && transmits) return;
    Lobes allowed;
    for (const Lobe& lobe : lobes)
      if (lobe.is_transmitted ? transmits : reflects) allowed.push_back(lobe);
    lobes = allowed;
  }

  Vec2 point(const Path& path, dimension::Bounce use) const {
    return sampler_.point(path.id, dimension::of_bounce(path.depth, use));
  }

  void add_emission(Path& path, const Ray& ray, const Hit& hit, const Surface& surface,
                    const Material& material, const Interaction& at) {
    if (!is_luminaire(material)) return;
    Color light = path.throughput * emission_at(scene_, pose_, hit.instance, material, at);
    if (path.pdf > 0)
      if (const uint32_t source = find_luminaire(scene_, hit.instance, hit.primitive); source != kNone)
        light *= balance(path.pdf, choice_probability(scene_, source) *
                                       light_pdf(scene_, pose_, scene_.lights[source], ray.origin, surface));
    colors_[path.place] += light;
  }

  static bool is_followed(const Material& material, const Lobe& lobe) {
    return lobe.is_transmitted || (has_reflected_rays(material) && lobe.spread != Lobe::Spread::diffuse);
  }

  /// A shadow ray to one of the sources. `followed`: the lobes along which paths may find it, too.
  void add_direct_light(const Path& path, const Surface& surface, const Interaction& at, const Lobes& lobes,
                        const Lobes& followed) {
    if (scene_.lights.empty()) return;
    const uint32_t source =
        scene_.lights.size() > 1 ? choose_light(scene_, point(path, dimension::kLight).x) : 0;
    const Light& light = scene_.lights[source];
    const Vec2 u = has_extent(light) ? point(path, dimension::kLightPoint) : Vec2(0);
    const LightSample sample = sample_light(scene_, pose_, light, surface.p, u);
    if (sample.incident == Color(0)) return;
    // Where smooth normals disagree with the surface, light must not come from the wrong side of it.
    if ((glm::dot(surface.geometric_normal, sample.to_light) > 0) !=
        (glm::dot(at.normal, sample.to_light) > 0))
      return;
    const Scattered scattered = eval(lobes, at, sample.to_light);
    if (scattered.value == Color(0)) return;
    const double probability = choice_probability(scene_, source);
    // What paths may bring, too, is weighed against them; what they do not follow, shadow rays alone bring.
    const Scattered shared = &followed == &lobes ? scattered : eval(followed, at, sample.to_light);
    const double weight = sample.pdf > 0 ? balance(sample.pdf * probability, shared.pdf) : 1;
    Color color = path.throughput * shared.value * sample.incident * (weight / probability);
    if (&followed != &lobes)
      color += path.throughput * (scattered.value - shared.value) * sample.incident / probability;
    const Vec3 origin = surface.ray_origin(sample.to_light);
    if (is_by_medium_) [[unlikely]]
      leave(scene_, surface, sample.to_light, shadow_media_[path.place]);
    shadows_.push_back(origin, sample.target - origin, color, path.place);
  }

  bool survives(Path& path, double u) const {
    const double strength = max_component(path.throughput);
    if (!(strength > 0)) return false;
    if (path.depth < kFirstRoulette) return true;
    const double chance = std::min(1.0, std::sqrt(strength));
    if (u >= chance) return false;
    path.throughput /= chance;
    return true;
  }

  const FrameContext& context_;
  const Scene& scene_;
  const Pose& pose_;
  const RenderSettings& settings_;
  const Sampler& sampler_;
  bool is_in_lanes_, is_by_medium_;
  RayCounts& counts_;
  Color* colors_;  ///< of the eye rays
  size_t eye_hits_ = 0;
  std::span<const SampleId> ids_;
  uint32_t depth_ = 1;    ///< of all paths: each step adds one
  OfPacket<Path> paths_;  ///< by place; throughput and pdf stand in lanes_
  PathLanes lanes_;       ///< in the order of the rays
  ShadowLanes shadows_;
  std::array<Media, kMostPacketRays> shadow_media_;  ///< by place, where rays have to know
};

class PathIntegrator : public Integrator {
 public:
  explicit PathIntegrator(bool is_in_lanes) : is_in_lanes_(is_in_lanes) {}

 private:
  size_t follow(const FrameContext& context, const RayPacket& rays, std::span<const SampleId> ids,
                RayCounts& counts, Color* colors) override {
    return PathTracer(context, is_in_lanes_, counts, colors).trace(rays, ids);
  }

  bool is_in_lanes_;
};

}  // namespace

std::unique_ptr<Integrator> make_path() {
  return std::make_unique<PathIntegrator>(true);
}

std::unique_ptr<Integrator> make_path_one_by_one() {
  return std::make_unique<PathIntegrator>(false);
}

}  // namespace rayfarm
