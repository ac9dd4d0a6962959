#include "common/lighting/integrators/path_tracer.h"

namespace rayfarm {

void PathTracer::read_media(const Hit* hits) {
  ShadowLanes shadows;
  for (size_t lane = 0; lane < lanes_.rays.size; ++lane) {
    const Ray ray{lanes_.rays.origin(lane), lanes_.rays.direction(lane), hits[lane].t};
    const Color throughput = lane_of(lanes_.throughput, lane);
    LitMediumPoint lit;
    const double u =
        sampler_.point(ids_[lanes_.places[lane]], dimension::of_walk(depth_, dimension::kFree)).x;
    colors_[lanes_.places[lane]] += throughput * context_.zones->radiance_of_media(
                                                     ray, !paths_[lanes_.places[lane]].is_gathering, u, lit);
    if (lit.medium != kNone) {
      set_lane(lanes_.throughput, lane, throughput * lit.throughput);
      light_in_media(stage(), lane, {lit.medium, lit.t}, lanes_, shadows);
    }
    set_lane(lanes_.throughput, lane, throughput * transmittance(scene_, ray));
  }
  add_unblocked(shadows);
}

LaneSet PathTracer::visit_media(const Hit* hits, LaneSet& go_on) {
  LaneSet scattered = 0;
  for (size_t lane = 0; lane < lanes_.rays.size; ++lane) {
    const MediumEvent event = walk_in_media(stage(), lane, hits[lane].t, lanes_);
    if (!event.is_scattered()) continue;
    scattered |= LaneSet{1} << lane;
    Path& path = paths_[lanes_.places[lane]];
    if (depth_ == 1 && hits[lane].is_hit()) ++eye_hits_;
    if (depth_ >= settings_.max_depth || path.reflections >= settings_.max_reflections) continue;
    if (!path.media.is_in_air())
      set_lane(lanes_.throughput, lane,
               lane_of(lanes_.throughput, lane) * path.media.transmittance(scene_, event.t));
    path.width += event.t * path.spread;
    path.spread = kDiffuseSpread;
    if (!scatter_in_media(stage(), lane, event, lanes_, shadows_)) continue;
    go_on |= LaneSet{1} << lane;
    ++path.reflections;
    ++counts_[RayKind::diffuse];
  }
  return scattered;
}

void PathTracer::keep_real(Hit* hits) {
  MediaOfRays media{};
  for (size_t lane = 0; lane < lanes_.rays.size; ++lane) {
    const uint32_t place = lanes_.places[lane];
    media[lane] = &paths_[place].media;
    shadow_media_[place] = paths_[place].media;
  }
  keep_real_hits(context_, lanes_.rays, media, hits);
}

uint32_t PathTracer::find_really_blocked(const ShadowLanes& shadows) const {
  MediaOfRays media{};
  for (size_t i = 0; i < shadows.rays.size; ++i) media[i] = &shadow_media_[shadows.places[i]];
  return any_real_hits(context_, shadows.rays, media, shadows.rays.all());
}

}  // namespace rayfarm
