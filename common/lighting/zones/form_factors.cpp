#include "common/lighting/zones/form_factors.h"

#include "common/lighting/pulse.h"
#include "common/lighting/zones/lit_surface.h"
#include "common/lighting/zones/zone_directions.h"

namespace rayfarm {
namespace {

/// Fewer rays tell too little of what a zone sees.
constexpr uint64_t kLeastRays = 64;

/// A place in the middle of a cell; triangles are warped so that it is where the medians meet.
Vec2 middle_of(const ZoneGrid& grid) {
  return grid.shape == ZoneShape::triangle ? Vec2(5.0 / 9, 0.5) : Vec2(0.5);
}

}  // namespace

void write(PackedWriter& out, const FormFactorRow& row) {
  out.number(row.total);
  if (row.total == 0) return;
  out.number(row.escaped);
  out.number(row.seen.size());
  uint64_t next = 0;
  for (const FormFactorRow::Seen& seen : row.seen) {
    out.number(seen.slot - next);
    out.number(seen.weight);
    next = seen.slot + 1;
  }
}

FormFactorRow read_form_factors(PackedReader& in, uint64_t slots) {
  FormFactorRow row;
  row.total = in.number();
  if (row.total == 0) return row;
  row.escaped = in.number();
  if (row.escaped > row.total) throw PackedReader::damaged();
  uint64_t left = row.total - row.escaped, next = 0;
  for (uint64_t count = in.number(); count > 0; --count) {
    const uint64_t skipped = in.number(), weight = in.number();
    if (skipped >= slots - next || weight == 0 || weight > left) throw PackedReader::damaged();
    row.seen.push_back({next + skipped, weight});
    next += skipped + 1;
    left -= weight;
  }
  return row;
}

uint64_t form_factor_rays(const ZoneSettings& settings, uint64_t slots) {
  if (settings.form_factors == FormFactors::hemicube) return Hemicube(settings.hemicube_cells).count();
  return std::max(kLeastRays, settings.rays / std::max<uint64_t>(slots, 1));
}

/// Rays on their way, and what others saw.
struct FormFactorTracer::Sighted {
  RayPacket rays;
  std::array<uint64_t, kMostPacketRays> weights;
  std::array<SampleId, kMostPacketRays> ids;
  RayCounts& counts;
  FormFactorRow row;
  std::vector<FormFactorRow::Seen> seen;

  void push(const Surface& from, const Vec3& direction, uint64_t weight, const SampleId& id) {
    weights[rays.size] = weight;
    ids[rays.size] = id;
    rays.push_back(from.ray_origin(direction), direction);
    row.total += weight;
  }
};

FormFactorTracer::FormFactorTracer(const ZoneScene& zones, const Sampler& sampler,
                                   const RenderSettings& settings)
    : zones_(zones),
      sampler_(sampler),
      settings_(settings),
      rays_(form_factor_rays(settings.zones, zones.map().slot_count())) {}

FormFactorRow FormFactorTracer::trace(uint64_t slot, const std::function<void()>& pulse,
                                      RayCounts& counts) const {
  const ZoneMap& map = zones_.map();
  const SlotPlace place = map.place_of_slot(slot);
  if (!(map.area(map.grids()[place.grid], place.cell) > 0) || !is_sent_on(zones_, slot)) return {};
  Sighted sighted{{}, {}, {}, counts, {}, {}};
  if (settings_.zones.form_factors == FormFactors::hemicube)
    trace_hemicube(place, slot, pulse, sighted);
  else
    trace_rays(place, slot, pulse, sighted);
  see(sighted);
  std::vector<FormFactorRow::Seen>& seen = sighted.seen;
  std::sort(seen.begin(), seen.end(), [](const auto& a, const auto& b) { return a.slot < b.slot; });
  for (const FormFactorRow::Seen& one : seen)
    if (!sighted.row.seen.empty() && sighted.row.seen.back().slot == one.slot)
      sighted.row.seen.back().weight += one.weight;
    else
      sighted.row.seen.push_back(one);
  return std::move(sighted.row);
}

void FormFactorTracer::trace_rays(const SlotPlace& place, uint64_t slot, const std::function<void()>& pulse,
                                  Sighted& sighted) const {
  const ZoneMap& map = zones_.map();
  for (uint64_t i = 0; i < rays_; ++i) {
    const SampleId id{static_cast<int>(slot & 0x7fffffff), static_cast<int>(slot >> 31),
                      static_cast<uint32_t>(i)};
    const ZonePoint point =
        sample_zone(map, sampler_, settings_.seed, map.grids()[place.grid], place.cell, place.side, id);
    const Vec3 local = direction_at(sampler_.point(id, dimension::of_bounce(0, dimension::kDirection)));
    const DirectionFrame frame(point.surface.geometric_normal, point.tangent);
    sighted.push(point.surface, frame.to_world(local), 1, id);
    if (sighted.rays.is_full()) see(sighted);
    if (i % kRaysPerPulse == 0) pulse();
  }
}

void FormFactorTracer::trace_hemicube(const SlotPlace& place, uint64_t slot,
                                      const std::function<void()>& pulse, Sighted& sighted) const {
  const ZoneGrid& grid = zones_.map().grids()[place.grid];
  const Vec2 middle = middle_of(grid);
  const ZonePoint point =
      zones_.map().point(grid, place.cell, place.side, middle, [&](uint32_t) { return middle; });
  const DirectionFrame frame(point.surface.geometric_normal, point.tangent);
  const Hemicube hemicube(settings_.zones.hemicube_cells);
  for (uint64_t i = 0; i < hemicube.count(); ++i) {
    const HemicubePixel pixel = hemicube[i];
    const SampleId id{static_cast<int>(slot & 0x7fffffff), static_cast<int>(slot >> 31),
                      static_cast<uint32_t>(i)};
    sighted.push(point.surface, frame.to_world(pixel.direction), pixel.weight, id);
    if (sighted.rays.is_full()) see(sighted);
    if (i % kRaysPerPulse == 0) pulse();
  }
}

/// What is no zone that sends diffuse light on, and what a polish turns back, is seen as nothing.
void FormFactorTracer::see(Sighted& sighted) const {
  if (sighted.rays.empty()) return;
  const ZoneMap& map = zones_.map();
  const Scene& scene = zones_.scene(0);
  sighted.counts[RayKind::diffuse] += sighted.rays.size;
  std::array<Hit, kMostPacketRays> hits;
  closest_hits(scene, map.pose(), sighted.rays, hits.data());
  for (size_t i = 0; i < sighted.rays.size; ++i) {
    const Hit& hit = hits[i];
    uint64_t weight = sighted.weights[i];
    if (!hit.is_hit()) {
      sighted.row.escaped += weight;
      continue;
    }
    const ZoneGrid* const grid = map.grid_of(hit);
    if (!grid || !grid->store.is_diffuse) continue;
    const Ray ray = sighted.rays[i];
    const Surface surface = eval_surface(scene, map.pose(), ray, hit);
    const InstancePose& pose = map.pose()[hit.instance];
    const Vec3 p_object = pose.in_object(surface.p);
    const uint64_t slot =
        grid->slot(map.cell_at(*grid, map.place_of(*grid, hit, p_object)), surface.is_front ? 0 : 1);
    if (!is_sent_on(zones_, slot)) continue;
    if (may_be_polished(scene.materials[grid->material])) {
      const SampleId& id = sighted.ids[i];
      const double passed = passed_by_polish(
          look_at(scene, map, surface, hit, -ray.direction, sampler_.point(id, dimension::of_mix(0)).x));
      // Of a ray all or nothing.
      weight = weight == 1
                   ? (sampler_.point(id, dimension::of_bounce(0, dimension::kLobe)).x < passed ? 1 : 0)
                   : static_cast<uint64_t>(std::floor(static_cast<double>(weight) * passed + 0.5));
      if (weight == 0) continue;
    }
    sighted.seen.push_back({slot, weight});
  }
  sighted.rays.clear();
}

}  // namespace rayfarm
