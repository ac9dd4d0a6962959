#include "common/lighting/integrators/path_step.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/lighting/integrators/path_step.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <bit>

#include "common/lighting/light_choice.h"
#include "common/lighting/light_sampling-inl.h"
#include "common/lighting/surface-inl.h"
#include "common/materials/scattering-inl.h"
#include "common/sampling/sobol-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayfarm {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// As balance of one number.
HWY_INLINE Real balance(Real used, Real other) {
  const Real ratio = other / used;
  return real(1) / (real(1) + ratio * ratio);
}

/// What the lanes' materials scatter: at most a diffuse lobe about the normal, one straight through and a
/// mirror's. A lobe that is not there attenuates all.
struct RealLobes {
  HWY_INLINE RealLobes() {}               // one that GCC makes is not of the target
  Real3 diffuse, transmitted, reflected;  ///< attenuations
  Real3 through, mirror;                  ///< directions
  Truth has_diffuse, has_transmitted, has_reflected;
  Truth is_mirror_first;  ///< in the material's list
};

/// One vector's lanes of a packet, from `lane` on.
class LanesStep {
 public:
  HWY_INLINE LanesStep(const PathStage& stage, PathLanes& paths, ShadowLanes& shadows, size_t lane,
                       LaneSet lanes)
      : stage_(stage),
        scene_(stage.context.scene),
        pose_(stage.context.pose),
        sampler_(stage.context.tables.sampler),
        paths_(paths),
        shadows_(shadows),
        lane_(lane),
        bits_(lanes),
        ours_(truth_of(lanes)),
        zero_(hn::Zero(RealTag())) {}

  HWY_INLINE PathStep run() {
    PathStep result;
    // Where there is no path any directions stand in: none that cost more than others.
    const Real3 upright(zero_, zero_, real(1));
    to_viewer_ = select(ours_, -load(paths_.rays.directions, ours_), upright);
    p_ = load(paths_.surfaces.p, ours_);
    geometric_normal_ = select(ours_, load(paths_.surfaces.geometric_normal, ours_), upright);
    const Real3 shading_normal = load(paths_.surfaces.shading_normal, ours_);
    normal_ = select(dot(to_viewer_, shading_normal) > zero_, shading_normal, geometric_normal_);
    offset_ = load(paths_.surfaces.offset, ours_);
    throughput_ = load(paths_.throughput, ours_);

    const RealLobes lobes = scatter();
    const Real diffuse = luminance(lobes.diffuse);
    const Real total = diffuse + luminance(lobes.transmitted) + luminance(lobes.reflected);
    const Truth is_lit = hn::And(total > zero_, ours_);
    const Real diffuse_share = diffuse / total;
    if (stage_.part != StepPart::direction && !scene_.lights.empty())
      if (const LaneSet lit = bits_of(hn::And(is_lit, lobes.has_diffuse)); lit != 0)
        add_direct_light(lit, lobes.diffuse, diffuse_share);
    if (stage_.part != StepPart::light) follow(lobes, total, diffuse_share, is_lit, result);
    return result;
  }

 private:
  /// 0 in the other lanes. What was never set may be a denormal number, which takes a hundred cycles to look
  /// at.
  HWY_INLINE Real load(const double* lanes, Truth which) const {
    return hn::MaskedLoad(which, RealTag(), lanes + lane_);
  }
  HWY_INLINE Real3 load(const VectorLanes& axes, Truth which) const {
    return {load(axes[0], which), load(axes[1], which), load(axes[2], which)};
  }
  HWY_INLINE Truth set_at(LaneSet set) const { return truth_of(set >> lane_); }
  HWY_INLINE bool is_any(LaneSet set) const { return (set >> lane_ & bits_) != 0; }
  static HWY_INLINE bool is_any(Truth truth) { return !hn::AllFalse(RealTag(), truth); }

  /// The lanes' points of one use.
  HWY_INLINE Real2 points(dimension::Bounce use) const {
    const uint32_t dimension = dimension::of_bounce(stage_.depth, use);
    if (HWY_LIKELY(sampler_.is_sobol()))
      return sobol_points(hn::Load(WordTag(), paths_.pixel_keys + lane_),
                          hn::Load(HalfWordTag(), paths_.reversed_samples + lane_),
                          sampler_.frame_and_dimension(dimension));
    HWY_ALIGN RealLanes x{}, y{};
    for_each_lane(bits_, [&](size_t i) {
      const Vec2 u = sampler_.point(stage_.ids[paths_.places[lane_ + i]], dimension);
      x[i] = u.x;
      y[i] = u.y;
    });
    return {hn::Load(RealTag(), x), hn::Load(RealTag(), y)};
  }

  /// As the families' functions in materials.cpp, without what is reflected or transmitted too often.
  HWY_INLINE RealLobes scatter() const {
    RealLobes lobes;
    const Truth substrates = set_at(paths_.substrates), dielectrics = set_at(paths_.dielectrics),
                classical = set_at(paths_.classical), polished = set_at(paths_.polished);
    Real3 diffuse = load(paths_.substrate, substrates), transmitted = all(zero_), reflected = all(zero_);
    lobes.has_diffuse = substrates;
    lobes.has_transmitted = lobes.has_reflected = hn::FirstN(RealTag(), 0);
    lobes.is_mirror_first = hn::Or(polished, dielectrics);
    lobes.through = lobes.mirror = all(zero_);
    if (is_any(paths_.polished | paths_.dielectrics | paths_.conductors | paths_.classical)) {
      const Real cosine = dot(normal_, to_viewer_),
                 index_ratio = select(ours_, load(paths_.index_ratio, ours_), real(1));
      Truth is_total = hn::FirstN(RealTag(), 0);
      if (is_any(paths_.dielectrics | paths_.classical)) {
        lobes.through = refracted(to_viewer_, normal_, index_ratio, is_total);
        lobes.through = select(is_total, all(zero_), lobes.through);
      }
      if (is_any(paths_.polished | paths_.dielectrics)) {
        const Real reflectance = fresnel_dielectric(cosine, index_ratio), left = real(1) - reflectance;
        reflected = all(reflectance);
        diffuse = select(polished, left * diffuse, diffuse);
        transmitted = all(left / (index_ratio * index_ratio));
        lobes.has_reflected = hn::Or(polished, hn::And(dielectrics, reflectance > zero_));
        lobes.has_transmitted = hn::And(dielectrics, reflectance < real(1));
      }
      if (is_any(paths_.conductors)) {
        const Truth conductors = set_at(paths_.conductors);
        reflected = select(conductors,
                           fresnel_conductor(cosine, load(paths_.n, conductors), load(paths_.k, conductors)),
                           reflected);
        lobes.has_reflected = hn::Or(lobes.has_reflected, conductors);
      }
      if (is_any(paths_.classical)) {
        const Real transmit = load(paths_.transmit, classical), reflect = load(paths_.reflect, classical);
        const Truth transmits = hn::And(classical, transmit > zero_);
        const Real all_reflected = select(hn::And(transmits, is_total), reflect + transmit, reflect);
        reflected = select(classical, all(all_reflected), reflected);
        transmitted = select(classical, load(paths_.through, classical), transmitted);
        lobes.has_reflected = hn::Or(lobes.has_reflected, hn::And(classical, all_reflected > zero_));
        lobes.has_transmitted = hn::Or(lobes.has_transmitted, hn::AndNot(is_total, transmits));
      }
      lobes.mirror = mirrored(to_viewer_, normal_);
    }
    const Truth can_reflect = set_at(paths_.can_reflect);
    lobes.has_diffuse = hn::And(lobes.has_diffuse, can_reflect);
    lobes.has_reflected = hn::And(lobes.has_reflected, can_reflect);
    lobes.has_transmitted = hn::And(lobes.has_transmitted, set_at(paths_.can_transmit));
    lobes.diffuse = select(lobes.has_diffuse, diffuse, all(zero_));
    lobes.transmitted = select(lobes.has_transmitted, transmitted, all(zero_));
    lobes.reflected = select(lobes.has_reflected, reflected, all(zero_));
    return lobes;
  }

  /// Samples of the sources that the lanes of `lit` choose, and the probabilities of these.
  HWY_INLINE RealLightSample sample_lights(LaneSet lit, Real& probability) const {
    const RealTag d;
    uint32_t sources[8]{};
    if (scene_.lights.size() > 1) {
      HWY_ALIGN RealLanes choices;
      hn::Store(points(dimension::kLight).x, d, choices);
      for_each_lane(lit, [&](size_t i) { sources[i] = choose_light(scene_, choices[i]); });
    }
    bool has_extent_anywhere = false;
    for_each_lane(lit, [&](size_t i) { has_extent_anywhere |= has_extent(scene_.lights[sources[i]]); });
    const Real2 u = has_extent_anywhere ? points(dimension::kLightPoint) : Real2{zero_, zero_};

    RealLightSample result{all(zero_), all(zero_), all(zero_), zero_};
    probability = real(1);
    LaneSet one_by_one = 0;
    for (LaneSet rest = lit; rest != 0;) {  // a source after the other
      const uint32_t source = sources[std::countr_zero(rest)];
      LaneSet these = 0;
      for_each_lane(rest, [&](size_t i) { these |= static_cast<LaneSet>(sources[i] == source) << i; });
      rest &= ~these;
      probability = select(truth_of(these), real(choice_probability(scene_, source)), probability);
      RealLightSample sample;
      const LaneSet done = sample_light_in_lanes(scene_, pose_, scene_.lights[source], p_, u, sample) & these;
      one_by_one |= these & ~done;
      if (done == 0) continue;
      const Truth here = truth_of(done);
      result.to_light = select(here, sample.to_light, result.to_light);
      result.target = select(here, sample.target, result.target);
      result.incident = select(here, sample.incident, result.incident);
      result.pdf = select(here, sample.pdf, result.pdf);
    }
    if (HWY_UNLIKELY(one_by_one != 0)) sample_lights_one_by_one(one_by_one, sources, u, result);
    return result;
  }

  HWY_NOINLINE void sample_lights_one_by_one(LaneSet lanes, const uint32_t* sources, const Real2& u,
                                             RealLightSample& result) const {
    const RealTag d;
    HWY_ALIGN RealLanes x, y, to_light[3], target[3], incident[3], pdf;
    hn::Store(u.x, d, x);
    hn::Store(u.y, d, y);
    store3(result.to_light, to_light, 0);
    store3(result.target, target, 0);
    store3(result.incident, incident, 0);
    hn::Store(result.pdf, d, pdf);
    for_each_lane(lanes, [&](size_t i) {
      const LightSample sample = sample_light(scene_, pose_, scene_.lights[sources[i]],
                                              lane_of(paths_.surfaces.p, lane_ + i), Vec2(x[i], y[i]));
      set_lane(to_light, i, sample.to_light);
      set_lane(target, i, sample.target);
      set_lane(incident, i, sample.incident);
      pdf[i] = sample.pdf;
    });
    result.to_light = load3(to_light, 0);
    result.target = load3(target, 0);
    result.incident = load3(incident, 0);
    result.pdf = hn::Load(d, pdf);
  }

  HWY_INLINE Real3 ray_origin(const Real3& direction) const {
    return HWY_NAMESPACE::ray_origin(p_, geometric_normal_, offset_, direction);
  }

  /// A shadow ray to one of the sources; only what is reflected diffusely shows its light.
  HWY_INLINE void add_direct_light(LaneSet lit, const Real3& diffuse, Real diffuse_share) {
    Real probability;
    const RealLightSample sample = sample_lights(lit, probability);
    const Real cosine = dot(normal_, sample.to_light);
    const Real density = cosine_pdf(cosine);
    const Real3 value = density * diffuse;
    const auto is_black = [&](const Real3& c)
                              HWY_ATTR { return hn::And(hn::And(c.x == zero_, c.y == zero_), c.z == zero_); };
    const Truth is_before = dot(geometric_normal_, sample.to_light) > zero_;
    Truth is_seen = hn::AndNot(is_black(sample.incident), truth_of(lit));
    is_seen = hn::And(is_seen, hn::And(is_before, cosine > zero_));
    is_seen = hn::AndNot(is_black(value), is_seen);
    const LaneSet seen = bits_of(is_seen);
    if (seen == 0) return;
    const Real weight =
        select(sample.pdf > zero_, balance(sample.pdf * probability, diffuse_share * density), real(1));
    const Real3 origin = ray_origin(sample.to_light), to_target = sample.target - origin,
                color = (weight / probability) * (throughput_ * value * sample.incident);
    HWY_ALIGN RealLanes origins[3], to_targets[3], colors[3];
    store3(origin, origins, 0);
    store3(to_target, to_targets, 0);
    store3(color, colors, 0);
    for_each_lane(seen, [&](size_t i) {
      shadows_.push_back(lane_of(origins, i), lane_of(to_targets, i), lane_of(colors, i),
                         paths_.places[lane_ + i]);
    });
  }

  /// The direction in which paths go on: a lobe chosen by its share of the light, and a direction of it.
  HWY_INLINE void follow(const RealLobes& lobes, Real total, Real diffuse_share, Truth is_lit,
                         PathStep& result) {
    const RealTag d;
    const Truth several =
        hn::Or(hn::And(lobes.has_diffuse, hn::Or(lobes.has_transmitted, lobes.has_reflected)),
               hn::And(lobes.has_transmitted, lobes.has_reflected));
    const bool is_several = is_any(hn::And(several, is_lit));
    const Real2 choice = is_several || stage_.is_risky ? points(dimension::kLobe) : Real2{zero_, zero_};
    Truth chose_diffuse = lobes.has_diffuse, chose_transmitted = lobes.has_transmitted,
          chose_reflected = lobes.has_reflected;
    if (is_several) choose(lobes, choice.x * total, chose_diffuse, chose_transmitted, chose_reflected);

    Real3 direction = select(chose_transmitted, lobes.through, lobes.mirror);
    const Real3 attenuation = select(chose_transmitted, lobes.transmitted, lobes.reflected);
    Real3 weight = attenuation / (luminance(attenuation) / total);
    Truth goes_on = hn::And(is_lit, luminance(attenuation) / total > zero_);
    Real pdf = zero_;
    if (is_any(hn::And(chose_diffuse, is_lit))) {
      const Real3 diffuse_direction = to_world(normal_, sample_cosine(points(dimension::kDirection)));
      const Real cosine = dot(normal_, diffuse_direction), density = cosine_pdf(cosine);
      const Real shared = diffuse_share * density;
      const Real3 mean = (density * lobes.diffuse) / shared;
      const Truth is_there =
          hn::And(hn::And(is_lit, diffuse_share > zero_), hn::And(cosine > zero_, shared > zero_));
      direction = select(chose_diffuse, diffuse_direction, direction);
      weight = select(chose_diffuse, select(several, mean, lobes.diffuse), weight);
      pdf = hn::IfThenElseZero(chose_diffuse, select(several, shared, density));
      goes_on = select_truth(chose_diffuse, is_there, goes_on);
    }
    const Truth is_before = dot(geometric_normal_, direction) > zero_;
    goes_on = hn::And(goes_on, hn::Xor(is_before, chose_transmitted));
    Real3 throughput = throughput_ * weight;
    const Real strength = hn::Max(throughput.x, hn::Max(throughput.y, throughput.z));
    goes_on = hn::And(goes_on, strength > zero_);
    if (stage_.is_risky) {
      const Real chance = hn::Min(real(1), hn::Sqrt(strength));
      goes_on = hn::And(goes_on, choice.y < chance);
      throughput = throughput / chance;
    }
    result.go_on = bits_of(goes_on);
    result.is_diffuse = bits_of(hn::And(goes_on, chose_diffuse));
    result.is_transmitted = bits_of(hn::And(goes_on, chose_transmitted));
    // The lanes of others are theirs to set.
    const auto set3 = [&](const Real3& v, RealLanes* axes)
                          HWY_ATTR { store3(select(ours_, v, load3(axes, lane_)), axes, lane_); };
    set3(throughput, paths_.throughput);
    set3(ray_origin(direction), paths_.rays.origins);
    set3(direction, paths_.rays.directions);
    hn::Store(select(ours_, pdf, hn::Load(d, paths_.pdf + lane_)), d, paths_.pdf + lane_);
  }

  static HWY_INLINE Truth select_truth(Truth which, Truth yes, Truth no) {
    return hn::Or(hn::And(which, yes), hn::AndNot(which, no));
  }

  /// Which lobe holds `rest` of the light, in the material's order: where there is a mirror first only one
  /// other follows.
  static HWY_INLINE void choose(const RealLobes& lobes, Real rest, Truth& chose_diffuse,
                                Truth& chose_transmitted, Truth& chose_reflected) {
    const Real diffuse = luminance(lobes.diffuse), transmitted = luminance(lobes.transmitted),
               reflected = luminance(lobes.reflected);
    // The mirror, where it is first.
    const Truth first = hn::And(lobes.has_reflected, lobes.is_mirror_first);
    const Truth has_other = hn::Or(lobes.has_diffuse, lobes.has_transmitted);
    const Truth chose_first = hn::And(first, hn::Not(hn::And(has_other, rest >= reflected)));
    // The diffuse lobe, then the one through, then the mirror where it is last.
    const Truth last = hn::AndNot(lobes.is_mirror_first, lobes.has_reflected);
    const Truth past_diffuse = hn::And(hn::Or(lobes.has_transmitted, last), rest >= diffuse);
    chose_diffuse = hn::AndNot(chose_first, hn::And(lobes.has_diffuse, hn::Or(first, hn::Not(past_diffuse))));
    const Real beyond = select(lobes.has_diffuse, rest - diffuse, rest);
    const Truth past_transmitted = hn::And(last, beyond >= transmitted);
    chose_transmitted = hn::AndNot(hn::Or(chose_first, chose_diffuse),
                                   hn::And(lobes.has_transmitted, hn::Or(first, hn::Not(past_transmitted))));
    chose_reflected = hn::Or(chose_first, hn::AndNot(hn::Or(chose_diffuse, chose_transmitted), last));
  }

  const PathStage& stage_;
  const Scene& scene_;
  const Pose& pose_;
  const Sampler& sampler_;
  PathLanes& paths_;
  ShadowLanes& shadows_;
  size_t lane_;
  LaneSet bits_;  ///< of this vector's lanes
  Truth ours_;    ///< the same
  Real zero_;
  Real3 to_viewer_, p_, geometric_normal_, normal_, throughput_;
  Real offset_;
};

PathStep step_vectors(const PathStage& stage, LaneSet lanes, PathLanes& paths, ShadowLanes& shadows) {
  PathStep result;
  for (size_t lane = 0; lane < kMostPacketRays; lane += kLanes) {
    const LaneSet here = lanes_from(lanes, lane);
    if (here == 0) continue;
    const PathStep step = LanesStep(stage, paths, shadows, lane, here).run();
    result.go_on |= step.go_on << lane;
    result.is_diffuse |= step.is_diffuse << lane;
    result.is_transmitted |= step.is_transmitted << lane;
  }
  return result;
}

}  // namespace HWY_NAMESPACE
}  // namespace rayfarm
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayfarm {

HWY_EXPORT(step_vectors);

PathStep step_in_lanes(const PathStage& stage, LaneSet lanes, PathLanes& paths, ShadowLanes& shadows) {
  return HWY_DYNAMIC_DISPATCH(step_vectors)(stage, lanes, paths, shadows);
}

}  // namespace rayfarm
#endif
