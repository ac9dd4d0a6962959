#include "common/lighting/integrators/path_tracer.h"

namespace rayfarm {

void PathTracer::follow_split(LaneSet together) {
  const PathLanes lanes = lanes_;
  const OfPacket<Path> paths = paths_;
  const OfPacket<SampleId> ids = ids_;
  const std::vector<Turn> turns = std::move(turns_);
  const uint32_t depth = depth_;
  LaneSet all = together;
  for (const Turn& turn : turns) all |= LaneSet{1} << turn.lane;
  for (uint32_t i = 0; i < gather_rays_; ++i) {
    for_each_lane(all, [&](size_t lane) {
      const uint32_t place = lanes_.places[lane];
      Path& path = paths_[place];
      path.is_split = true;
      path.id = ids_[place] = sampler_.split(ids[place], i, gather_rays_);
      lanes_.pixel_keys[lane] = sampler_.pixel_key(path.id);
      lanes_.reversed_samples[lane] = reversed_bits(path.id.sample);
      set_lane(lanes_.throughput, lane, lane_of(lanes_.throughput, lane) / static_cast<double>(gather_rays_));
    });
    LaneSet go_on = together != 0 ? visit_together(together, StepPart::direction) : 0;
    for (const Turn& at : turns) {
      Path& path = paths_[lanes_.places[at.lane]];
      path.throughput = lane_of(lanes_.throughput, at.lane);
      Ray ray;
      if (!turn(path, ray, at.surface, at.at, at.lobes, at.is_dielectric)) continue;
      set_lane(lanes_.throughput, at.lane, path.throughput);
      lanes_.pdf[at.lane] = path.pdf;
      lanes_.rays.set(at.lane, ray.origin, ray.direction);
      go_on |= LaneSet{1} << at.lane;
    }
    lanes_.keep(go_on);
    for (++depth_; !lanes_.rays.empty(); ++depth_) step();
    lanes_ = lanes;
    paths_ = paths;
    depth_ = depth;
  }
  ids_ = ids;
}

}  // namespace rayfarm
