#include "common/lighting/integrators/path_media.h"

#include "common/lighting/light_choice.h"
#include "common/lighting/light_sampling.h"
#include "common/sampling/warps.h"

namespace rayfarm {
namespace {

/// A shadow ray from a point in a medium. `direction`: unit, in which the path came. `is_alone`: the path
/// will not find the source itself.
void add_direct_light(const PathStage& stage, const SampleId& id, const ParticipatingMedium& medium,
                      const Vec3& p, const Vec3& direction, const Color& throughput, uint32_t place,
                      bool is_alone, ShadowLanes& shadows) {
  const Scene& scene = stage.context.scene;
  if (scene.lights.empty()) return;
  const auto point = [&](dimension::Bounce use) {
    return stage.context.tables.sampler.point(id, dimension::of_bounce(stage.depth, use));
  };
  const uint32_t source = scene.lights.size() > 1 ? choose_light(scene, point(dimension::kLight).x) : 0;
  const Light& light = scene.lights[source];
  const Vec2 u = has_extent(light) ? point(dimension::kLightPoint) : Vec2(0);
  const LightSample sample = sample_light(scene, stage.context.pose, light, p, u);
  if (sample.incident == Color(0)) return;
  const double phase = henyey_greenstein_pdf(glm::dot(direction, sample.to_light), medium.asymmetry);
  const double probability = choice_probability(scene, source);
  const double weight = sample.pdf > 0 && !is_alone ? balance(sample.pdf * probability, phase) : 1;
  shadows.push_back(p, sample.target - p, (phase * weight / probability) * (throughput * sample.incident),
                    place);
}

}  // namespace

MediumEvent walk_in_media(const PathStage& stage, size_t lane, double t_max, PathLanes& paths) {
  const FrameContext& context = stage.context;
  MediumNumbers numbers(context.tables.sampler, stage.ids[paths.places[lane]],
                        dimension::of_walk(stage.depth, dimension::kFree));
  Color throughput = lane_of(paths.throughput, lane);
  const MediumEvent event = walk_through_media(
      context.scene, {paths.rays.origin(lane), paths.rays.direction(lane), t_max}, throughput, numbers);
  set_lane(paths.throughput, lane, throughput);
  return event;
}

void light_in_media(const PathStage& stage, size_t lane, const MediumEvent& event, const PathLanes& paths,
                    ShadowLanes& shadows) {
  const Vec3 origin = paths.rays.origin(lane), direction = paths.rays.direction(lane);
  add_direct_light(stage, stage.ids[paths.places[lane]], stage.context.scene.media[event.medium],
                   origin + event.t * direction, normalized(direction), lane_of(paths.throughput, lane),
                   paths.places[lane], true, shadows);
}

bool scatter_in_media(const PathStage& stage, size_t lane, const MediumEvent& event, PathLanes& paths,
                      ShadowLanes& shadows) {
  const FrameContext& context = stage.context;
  const SampleId& id = stage.ids[paths.places[lane]];
  const ParticipatingMedium& medium = context.scene.media[event.medium];
  const Vec3 p = paths.rays.origin(lane) + event.t * paths.rays.direction(lane),
             direction = normalized(paths.rays.direction(lane));
  Color throughput = lane_of(paths.throughput, lane);
  add_direct_light(stage, id, medium, p, direction, throughput, paths.places[lane], false, shadows);

  const auto point = [&](dimension::Bounce use) {
    return context.tables.sampler.point(id, dimension::of_bounce(stage.depth, use));
  };
  const Vec3 next =
      Frame(direction).to_world(sample_henyey_greenstein(point(dimension::kDirection), medium.asymmetry));
  const double strength = max_component(throughput);
  if (!(strength > 0)) return false;
  if (stage.is_risky) {
    const double chance = std::min(1.0, std::sqrt(strength));
    if (point(dimension::kLobe).y >= chance) return false;
    throughput /= chance;
  }
  set_lane(paths.throughput, lane, throughput);
  paths.pdf[lane] = henyey_greenstein_pdf(glm::dot(direction, next), medium.asymmetry);
  paths.rays.set(lane, p, next);
  return true;
}

void weaken_in_media(const PathStage& stage, LaneSet blocked, ShadowLanes& shadows) {
  const FrameContext& context = stage.context;
  for_each_lane(shadows.rays.all() & ~blocked, [&](size_t i) {
    MediumNumbers numbers(context.tables.sampler, stage.ids[shadows.places[i]],
                          dimension::of_walk(stage.depth, dimension::kShadow));
    set_lane(shadows.colors, i,
             lane_of(shadows.colors, i) * estimate_transmittance(context.scene, shadows.rays[i], numbers));
  });
}

}  // namespace rayfarm
