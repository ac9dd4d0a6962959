// The thesis's model (Equation 3.6a): Whitted's, with light from secondary sources in place of ambient light.
// Diffuse rays gather it in fixed directions (3.3), and lose strength on their way (3.2).
#include <algorithm>
#include <limits>
#include <numbers>

#include "common/lighting/environment.h"
#include "common/lighting/holes.h"
#include "common/lighting/integrators/integrator.h"
#include "common/lighting/integrators/lighting_tree.h"
#include "common/lighting/item_buffers.h"
#include "common/lighting/light_sampling.h"
#include "common/lighting/participating_media.h"

namespace rayfarm {
namespace {

/// Diffuse rays that are no farther apart than 60 degrees are neighbours.
constexpr double kLeastNeighborCosine = 0.5;

/// A ray that gathers diffuse light.
struct GatheringRay {
  Vec3 direction;
  bool serves_both;  ///< it is the reflected ray, too
  double distance;   ///< to what it met
  Color counted;     ///< of the light that it met: what shadow rays bring, too
  Color color;       ///< the diffuse light that it brought
};

/// The diffuse light at a surface, which rays gather: this sample's part of the pixel's directions, in
/// packets.
struct Gathering {
  Gathering(uint32_t of_fork, uint32_t at_depth, uint32_t of_directions, const Branch& of_branch,
            const Surface& at, double turn, const Color& of_ray)
      : fork(of_fork),
        depth(at_depth),
        part(of_directions),
        branch(of_branch),
        surface(at),
        frame(at.shading_normal, turn),
        share(of_ray) {}

  uint32_t fork;   ///< which it belongs to
  uint32_t depth;  ///< of the gathering rays
  uint32_t part;   ///< of the directions
  Branch branch;   ///< of the ray that met the surface
  Surface surface;
  TurnedFrame frame;
  Color share;  ///< of what a ray brings
  /// A reflected ray that falls into a diffuse ray's own cone serves both terms (3.4): the number of that
  /// ray, or kNone; the reflected ray's direction and share; what it saw.
  uint32_t both = kNone;
  Vec3 mirror{0};
  double reflect = 0;
  Color reflected{0};

  uint32_t next = 0;     ///< the first ray that is in no packet yet
  uint32_t pending = 0;  ///< rays on their way
  Color sum{0};          ///< of the packets before
  uint32_t count = 0;    ///< of the packet's rays
  uint32_t extras = 0;   ///< bit k: there is an extra ray before the packet's ray k
  GatheringRay last;     ///< of the packet before
  /// The packet's rays; then extra ones, each between a ray and the one before it.
  std::array<GatheringRay, 2 * kMostPacketRays> rays;
};
static_assert(std::is_trivially_copyable_v<Gathering>);

/// What is on its way, for one packet of eye rays.
struct Work {
  LightingTree tree;
  Pool<Gathering> gatherings;
  std::vector<uint32_t> ready;  ///< gatherings that wait for no ray
};

class ThesisTracer {
 public:
  ThesisTracer(const FrameContext& context, Work& work, RayCounts& counts)
      : context_(context),
        scene_(context.scene),
        settings_(context.tables.settings),
        tree_(work.tree),
        gatherings_(work.gatherings),
        ready_(work.ready),
        counts_(counts) {}

  size_t trace(const RayPacket& rays, std::span<const SampleId> ids, Color* colors) {
    gatherings_.clear();
    ready_.clear();
    const size_t eye_hits = trace(1, rays, tree_.plant(context_, ids, colors));
    while (true) {
      if (!ready_.empty()) {
        const uint32_t next = ready_.back();
        ready_.pop_back();
        resume(next);
      } else if (Batch* const batch = tree_.next_batch()) {
        trace(batch->depth, batch->rays, batch->branches);
        LightingTree::end(*batch);
      } else {
        counts_[RayTally::tree_depth] += tree_.depths();
        return eye_hits;
      }
    }
  }

 private:
  /// Returns how many rays met an object.
  size_t trace(uint32_t depth, const RayPacket& rays, OfPacket<Branch>& branches) {
    OfPacket<Hit> hits;
    if (depth == 1)
      find_eye_hits(context_, rays, hits.data());
    else
      closest_hits(scene_, context_.pose, rays, hits.data());
    if (is_by_medium(context_)) [[unlikely]]
      keep_real_hits(context_, rays, media_of(branches), hits.data());
    if (has_holes(context_)) [[unlikely]]
      pass_holes(context_, rays, branches, hits.data());
    ClassicalSurfaces surfaces(context_, rays, hits.data());
    for (size_t i = 0; i < rays.size; ++i) {
      Branch& branch = branches[i];
      if (!scene_.media.empty())
        branch.weaken(transmittance(scene_, {rays.origin(i), rays.direction(i), hits[i].t}));
      if (!hits[i].is_hit()) {
        take(tree_.deliver(branch.receiver, eval_background(scene_, rays.direction(i))));
        continue;
      }
      branch.arrive(scene_, hits[i].t);
      surfaces.begin(context_, i, branch.width, branch.id, branch.stream, &branch.media);
      GatheringRay* const ray = gathering_ray(branch.receiver);
      if (is_luminaire(*surfaces.materials[i])) add_emission(surfaces, i, branch, ray);
      if (!has_diffuse_rays(*surfaces.materials[i])) surfaces.add_ambient(scene_, i, AmbientColour::surface);
      if (!ray) continue;
      ray->distance = hits[i].t;
      if (!ray->serves_both) branch.weight *= strength(ray->distance);
    }
    if (surfaces.met) {
      add_direct_light(context_, {.has_reflected_rays = true}, surfaces, counts_);
      follow_others(depth, branches, surfaces);
    }
    return static_cast<size_t>(std::popcount(surfaces.met));
  }

  /// The rays that leave surfaces.
  void follow_others(uint32_t depth, const OfPacket<Branch>& branches, const ClassicalSurfaces& surfaces) {
    Batch *reflected = &tree_.begin_batch(depth + 1), *transmitted = &tree_.begin_batch(depth + 1);
    for_each_lane(surfaces.met, [&](size_t i) {
      const Branch& branch = branches[i];
      if (depth == settings_.max_depth || !add_rays(branch, surfaces, i, transmitted, reflected))
        take(tree_.deliver(branch.receiver, surfaces.light(i)));
    });
  }

  /// The ray of a gathering, if it is one's.
  GatheringRay* gathering_ray(const Receiver& receiver) {
    return receiver.kind == Receiver::Kind::own ? &gatherings_[receiver.fork].rays[receiver.place] : nullptr;
  }

  /// A primary source that shadow rays are sent to must not be counted again when a diffuse ray meets it.
  void add_emission(ClassicalSurfaces& surfaces, size_t i, const Branch& branch, GatheringRay* ray) const {
    const Hit& hit = surfaces.hits[i];
    const bool is_counted =
        branch.skips_sources && find_luminaire(scene_, hit.instance, hit.primitive) != kNone;
    const bool serves_both = ray && ray->serves_both;
    if (is_counted && !serves_both) return;
    const Color light = surfaces.emission(context_, i);
    surfaces.add_specular(i, light);
    if (is_counted) ray->counted = branch.receiver.share * light;
  }

  /// What a gathering ray brings, if that is what was delivered.
  void take(const std::optional<LightingTree::Delivery>& delivery) {
    if (!delivery) return;
    const auto& [receiver, color] = *delivery;
    Gathering& gathering = gatherings_[receiver.fork];
    GatheringRay& ray = gathering.rays[receiver.place];
    if (ray.serves_both) gathering.reflected = color;
    ray.color = weakened(ray.serves_both ? color - ray.counted : color, ray.distance);
    if (--gathering.pending == 0) ready_.push_back(receiver.fork);
  }

  /// How much of its light a diffuse ray of this length brings (thesis 3.2).
  double strength(double distance) const {
    if (!(settings_.diffuse_reach > 0)) return 1;
    const double ratio = distance / settings_.diffuse_reach;
    return 1 / (1 + ratio * ratio);
  }

  /// What a diffuse ray brings of the light that it met: ambient light stands in for what is lost.
  Color weakened(const Color& color, double distance) const {
    if (!(settings_.diffuse_reach > 0)) return color;
    const double s = strength(distance);
    return s * color + (1 - s) * scene_.head().ambient;
  }

  /// All rays that leave a surface. False: there are none.
  bool add_rays(const Branch& branch, const ClassicalSurfaces& surfaces, size_t i, Batch*& transmitted,
                Batch*& reflected) {
    const Material& material = *surfaces.materials[i];
    SecondaryRays secondary;
    if (surfaces.has_secondary_rays(i)) {
      secondary = secondary_rays(surfaces, i, branch, settings_);
      counts_[RayTally::cut] += secondary.cut_rays;
    }
    const Color share = (material.diffuse / settings_.diffuse_rays) * lane_of(surfaces.color, i);
    bool is_gathered = has_diffuse_rays(material) && branch.reflections < settings_.max_reflections &&
                       max_component(share) > 0;
    if (is_gathered && !(branch.weight * max_component(share) >= settings_.min_weight)) {
      is_gathered = false;
      counts_[RayTally::cut] += settings_.diffuse_rays;
    }
    if (!is_gathered && secondary.transmitted_rays + secondary.reflected_rays == 0) return false;
    const uint32_t fork = tree_.add_fork(branch.receiver, surfaces.light(i));
    if (is_gathered && begin_gathering(fork, transmitted->depth, branch, surfaces.at[i], share, secondary))
      secondary.reflected_rays = 0;
    counts_[RayKind::transmitted] += secondary.transmitted_rays;
    counts_[RayKind::reflected] += secondary.reflected_rays;
    tree_.grow_secondary(context_, fork, branch, surfaces, i, secondary, transmitted, reflected);
    return true;
  }

  /// Light from secondary sources (Equation 3.6a, second term). True: a diffuse ray serves the reflected
  /// term, too.
  bool begin_gathering(uint32_t fork, uint32_t depth, const Branch& branch, const Surface& surface,
                       const Color& share, const SecondaryRays& secondary) {
    SampleId pixel = branch.id;
    uint32_t part = pixel.sample;
    if (settings_.sampling == SamplingPattern::corners) {
      // A set covers as many corners as a pixel has, and is laid beside itself again and again: so any pixel
      // has each of its parts at one corner, wherever the set begins.
      const auto columns = static_cast<int>(settings_.subpixels.columns) + 1,
                 rows = static_cast<int>(settings_.subpixels.rows) + 1;
      const int column = pixel.x % columns, row = pixel.y % rows;
      part = static_cast<uint32_t>(column + columns * row);
      pixel.x -= column;
      pixel.y -= row;
    }
    double turn = 0;
    if (settings_.diffuse_set == DiffuseSet::turned) {
      // One turn for all samples of a set keeps it together; each takes a part of it, in random order.
      pixel.sample = 0;
      const auto r = random_pair(settings_.seed, context_.tables.sampler.frame(), pixel,
                                 branch.stream << 8 | dimension::kPattern);
      turn = 2 * std::numbers::pi * r[0];
      part = permuted(part, samples(), static_cast<uint64_t>(r[1] * 0x1p53));
    }
    const uint32_t place = gatherings_.add(fork, depth, part, branch, surface, turn, share);
    Gathering& gathering = gatherings_[place];
    // A lobe's rays are spread over it otherwise than diffuse rays; and what a ray sees of sources through
    // glass that shadow rays cross counts for the reflected term alone.
    if (secondary.reflected_rays == 1 && settings_.glass_shadows == GlassShadows::blocked) {
      gathering.mirror = secondary.reflected;
      gathering.reflect = secondary.reflect;
      gathering.both = ray_about_mirror(gathering);
    }
    ++tree_[fork].pending;
    ready_.push_back(place);
    return gathering.both != kNone;
  }

  /// That the directions of a pixel are spread over.
  uint32_t samples() const { return static_cast<uint32_t>(samples_that_share_directions(settings_)); }

  /// The first ray into whose own cone the mirror direction falls, or kNone.
  uint32_t ray_about_mirror(const Gathering& gathering) {
    // Of n rays each stands for 2π / n of the hemisphere: a cap of this cosine.
    const auto rays = static_cast<double>(context_.tables.diffuse_directions.about_y().size());
    const double cosine_of_cone = 1 - 1 / rays;
    for (uint32_t i = 0; i < settings_.diffuse_rays; ++i)
      if (glm::dot(direction_of(gathering, i), gathering.mirror) > cosine_of_cone) return i;
    return kNone;
  }

  Vec3 direction_of(const Gathering& gathering, uint32_t i) {
    const DiffuseDirections& directions = context_.tables.diffuse_directions;
    const size_t ray = gathering.part + size_t{i} * samples();
    if (!settings_.diffuse_jitter) return gathering.frame.to_world(directions.about_y()[ray]);
    const Branch& branch = gathering.branch;
    const uint32_t child = LightingTree::kFirstOwn + i;
    const auto stream = static_cast<uint32_t>(mix_bits(uint64_t{branch.stream} << 32 | child));
    const auto r = random_pair(settings_.seed, context_.tables.sampler.frame(), branch.id,
                               stream << 8 | dimension::kDirection);
    return gathering.frame.to_world(directions.jittered(ray, {r[0], r[1]}));
  }

  /// What follows once all rays are back: extra ones, the next packet, or the end.
  void resume(uint32_t place) {
    Gathering& gathering = gatherings_[place];
    if (gathering.extras == 0 && settings_.diffuse_contrast > 0 && send_extras(place)) return;
    add_up(gathering);
    if (gathering.next < settings_.diffuse_rays) {
      send_packet(place);
      return;
    }
    Color& color = tree_[gathering.fork].color;
    if (gathering.both != kNone) color += gathering.reflect * gathering.reflected;
    color += gathering.share * gathering.sum;
    gatherings_.release(place);
    take(tree_.settle(gathering.fork));
  }

  void send_packet(uint32_t place) {
    Gathering& gathering = gatherings_[place];
    gathering.count =
        std::min(settings_.diffuse_rays - gathering.next, static_cast<uint32_t>(kMostPacketRays));
    Batch& batch = tree_.batch_with_room(gathering.depth, gathering.count);
    for (uint32_t k = 0; k < gathering.count; ++k, ++gathering.next) {
      const bool serves_both = gathering.next == gathering.both;
      send(place, k, serves_both ? gathering.mirror : direction_of(gathering, gathering.next), serves_both,
           LightingTree::kFirstOwn + gathering.next, batch);
    }
  }

  /// One more ray between neighbours that differ (3.3). False: there are none.
  bool send_extras(uint32_t place) {
    Gathering& gathering = gatherings_[place];
    const uint32_t first = gathering.next - gathering.count;
    Batch& batch = tree_.batch_with_room(gathering.depth, gathering.count);
    for (uint32_t k = 0; k < gathering.count; ++k) {
      if (first + k == 0) continue;
      const GatheringRay &a = before(gathering, k), &b = gathering.rays[k];
      if (!(glm::dot(a.direction, b.direction) > kLeastNeighborCosine)) continue;
      if (!(gathering.branch.weight * max_magnitude(gathering.share * (a.color - b.color)) >
            settings_.diffuse_contrast))
        continue;
      gathering.extras |= 1u << k;
      send(place, kMostPacketRays + k, normalized(a.direction + b.direction), false,
           LightingTree::kFirstOwn + settings_.diffuse_rays + first + k, batch);
    }
    return gathering.extras != 0;
  }

  static const GatheringRay& before(const Gathering& gathering, uint32_t k) {
    return k == 0 ? gathering.last : gathering.rays[k - 1];
  }

  void send(uint32_t place, size_t ray, const Vec3& direction, bool serves_both, uint32_t child,
            Batch& batch) {
    Gathering& gathering = gatherings_[place];
    gathering.rays[ray] = {direction, serves_both, std::numeric_limits<double>::infinity(), Color(0),
                           Color(0)};
    ++gathering.pending;
    tree_.reach(gathering.branch, batch.depth);
    const Color share = serves_both ? gathering.share + gathering.reflect : gathering.share;
    Branch& branch =
        LightingTree::grow(gathering.branch, gathering.surface.ray_origin(direction), direction,
                           max_component(share), serves_both ? LightingTree::kReflected : child, batch);
    branch.receiver = {Receiver::Kind::own, place, static_cast<uint32_t>(ray)};
    branch.skips_sources = true;
    if (is_by_medium(context_)) [[unlikely]]
      leave(scene_, gathering.surface, direction, branch.media);
    ++branch.reflections;
    if (!serves_both) branch.spread = kDiffuseSpread;
    ++counts_[serves_both ? RayKind::reflected : RayKind::diffuse];
  }

  /// Of a packet that is back. An extra ray turns (a + b) / 2, what two neighbours see of the gap between
  /// them, into (a + 2 e + b) / 4.
  static void add_up(Gathering& gathering) {
    for (uint32_t k = 0; k < gathering.count; ++k) {
      const GatheringRay &a = before(gathering, k), &b = gathering.rays[k];
      gathering.sum += b.color;
      if (gathering.extras >> k & 1)
        gathering.sum += 0.25 * (2.0 * gathering.rays[kMostPacketRays + k].color - a.color - b.color);
    }
    if (gathering.count > 0) gathering.last = gathering.rays[gathering.count - 1];
    gathering.extras = 0;
  }

  const FrameContext& context_;
  const Scene& scene_;
  const RenderSettings& settings_;
  LightingTree& tree_;
  Pool<Gathering>& gatherings_;
  std::vector<uint32_t>& ready_;
  RayCounts& counts_;
};

class ThesisIntegrator : public Integrator {
 private:
  size_t follow(const FrameContext& context, const RayPacket& rays, std::span<const SampleId> ids,
                RayCounts& counts, Color* colors) override {
    return ThesisTracer(context, work_, counts).trace(rays, ids, colors);
  }

  Work work_;
};

}  // namespace

std::unique_ptr<Integrator> make_thesis() {
  return std::make_unique<ThesisIntegrator>();
}

}  // namespace rayfarm
