// The rendering equation without bias: paths that scatter as the materials do, a shadow ray to one source at
// each turn, both weighted by multiple importance sampling (Veach 1997), ended by Russian roulette. The
// reference for the other lighting models. Ambient light, their stand-in for what paths find, is left out.
#include <bit>

#include "common/lighting/holes.h"
#include "common/lighting/integrators/integrator.h"
#include "common/lighting/integrators/path_tracer.h"
#include "common/lighting/item_buffers.h"

namespace rayfarm {

size_t PathTracer::trace(const RayPacket& rays, std::span<const SampleId> ids) {
  lanes_.rays = rays;
  for (size_t i = 0; i < rays.size; ++i) {
    colors_[i] = Color(0);
    ids_.push_back(ids[i]);
    Path& path = paths_.emplace_back();
    path.place = static_cast<uint32_t>(i);
    path.id = ids[i];
    path.width = context_.width;
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

void PathTracer::step() {
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
  if (has_holes(context_)) [[unlikely]]
    pass_holes(hits.data());
  lanes_.clear_sets();
  shadows_.rays.clear();
  LaneSet together = 0, go_on = 0, met = 0;
  if (is_in_lanes_) {
    met = eval_surfaces(scene_, pose_, lanes_.rays, hits.data(), lanes_.surfaces);
    if (is_by_medium_) [[unlikely]]
      lay_on_surfaces(scene_, met, lanes_.surfaces);
  }
  LaneSet scattered = 0;
  if (has_media_) {
    if (context_.zones)
      read_media(hits.data());
    else
      scattered = visit_media(hits.data(), go_on);
  }
  if (is_in_lanes_) {
    if (context_.zones)
      for_each_lane(met, [&](size_t lane) {
        if (ends_at_zones(paths_[lanes_.places[lane]]) && context_.zones->grid_of(hits[lane]))
          met &= ~(LaneSet{1} << lane);
      });
    met &= ~scattered;
    if (depth_ >= settings_.max_depth) met = 0;
    for_each_lane(met, [&](size_t lane) {
      if (prepare(lane, hits[lane])) together |= LaneSet{1} << lane;
    });
  }
  LaneSet split = 0;
  if (gather_rays_ > 1) [[unlikely]] {
    turns_.clear();
    for_each_lane(together, [&](size_t lane) {
      if (is_split_here(lane)) split |= LaneSet{1} << lane;
    });
    if (split != 0) visit_together(split, StepPart::light);
  }
  if ((together & ~split) != 0) go_on |= visit_together(together & ~split);
  for (size_t lane = 0; lane < count; ++lane)
    if (!((together | scattered) >> lane & 1) && visit_alone(lane, hits[lane])) go_on |= LaneSet{1} << lane;
  add_unblocked(shadows_);
  if (gather_rays_ > 1 && (split != 0 || !turns_.empty())) [[unlikely]]
    follow_split(split);
  lanes_.keep(go_on);
}

void PathTracer::add_unblocked(ShadowLanes& shadows) {
  if (shadows.rays.empty()) return;
  counts_[RayKind::shadow] += shadows.rays.size;
  uint32_t blocked = is_by_medium_ ? find_really_blocked(shadows) : any_hits(scene_, pose_, shadows.rays);
  if (has_holes(context_)) [[unlikely]]
    light_holes(blocked, shadows);
  if (has_media_) weaken_in_media(stage(), blocked, shadows);
  for (size_t i = 0; i < shadows.rays.size; ++i)
    if (!(blocked >> i & 1)) colors_[shadows.places[i]] += lane_of(shadows.colors, i);
}

void PathTracer::pass_holes(Hit* hits) {
  for (size_t i = 0; i < lanes_.rays.size; ++i) {
    const Path& path = paths_[lanes_.places[i]];
    hits[i] = next_solid_hit(
        context_, lanes_.rays[i],
        {path.id, depth_ << 8, path.width, path.spread, is_by_medium_ ? &path.media : nullptr}, hits[i]);
  }
}

void PathTracer::light_holes(uint32_t& blocked, ShadowLanes& shadows) const {
  for_each_lane(blocked, [&](size_t i) {
    const double left = light_through_holes(context_, shadows.rays[i],
                                            is_by_medium_ ? &shadow_media_[shadows.places[i]] : nullptr);
    if (!(left > 0)) return;
    set_lane(shadows.colors, i, left * lane_of(shadows.colors, i));
    blocked &= ~(1u << i);
  });
}

bool PathTracer::visit_alone(size_t lane, const Hit& hit) {
  Path& path = paths_[lanes_.places[lane]];
  path.depth = depth_;
  path.throughput = lane_of(lanes_.throughput, lane);
  path.pdf = lanes_.pdf[lane];
  Ray ray = lanes_.rays[lane];
  Surface surface;
  if (hit.is_hit()) surface = is_in_lanes_ ? lanes_.surfaces[lane] : eval_surface(scene_, pose_, ray, hit);
  if (is_by_medium_ && hit.is_hit()) [[unlikely]]
    surface = laid_on_surface(scene_, surface);
  if (!visit(lane, path, ray, hit, surface)) return false;
  set_lane(lanes_.throughput, lane, path.throughput);
  lanes_.pdf[lane] = path.pdf;
  lanes_.rays.set(lane, ray.origin, ray.direction);
  return true;
}

bool PathTracer::prepare(size_t lane, const Hit& hit) {
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

LaneSet PathTracer::visit_together(LaneSet lanes, StepPart part) {
  const PathStep step = step_in_lanes(stage(part), lanes, lanes_, shadows_);
  for_each_lane(step.go_on, [&](size_t lane) {
    Path& path = paths_[lanes_.places[lane]];
    if (step.is_diffuse >> lane & 1) {
      path.spread = kDiffuseSpread;
      path.is_gathering = true;
    }
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

namespace {

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
