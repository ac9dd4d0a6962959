// A node's part of progressive refinement.
#include <numeric>

#include "common/lighting/pulse.h"
#include "common/lighting/zones/measured_light.h"
#include "common/lighting/zones/power_rays.h"
#include "common/lighting/zones/shooting.h"
#include "common/lighting/zones/zone_solver.h"

namespace rayfarm {
namespace {

/// More than are ever asked for.
constexpr double kMostRaysOfSender = 0x1p32;

class ZonalTracer : public ZoneTracer {
 public:
  ZonalTracer(const Scene& scene, const RenderSettings& settings, int frame)
      : settings_(settings),
        zones_(scene, settings, frame),
        sampler_({SamplingPattern::sobol, 1, settings.seed}, zones_.frame()),
        mirrors_(zones_.map()),
        colors_(zones_.passes()) {}

  void begin(std::span<const std::byte> stage_data) override {
    PackedReader in(stage_data);
    head_ = read_stage_head(in, zones_.passes());
    slots_.clear();
    unsent_.clear();
    first_ray_.assign(1, 0);
    senders_.emplace(zones_);
    if (head_.kind == ZoneStageKind::shoot || head_.kind == ZoneStageKind::emit) {
      in.sums(zones_.slot_count(), [&](uint64_t slot, const Power& power) {
        for (const int64_t q : power.quanta)
          if (q < 0 || q > kMostAtOnce) throw PackedReader::damaged();
        slots_.push_back(slot);
        unsent_.push_back(power);
        senders_->add(slot, power);
      });
      for (const ZoneSender& sender : senders_->all()) {
        if (!(head_.rays * (sender.power / head_.first) <= kMostRaysOfSender)) throw PackedReader::damaged();
        first_ray_.push_back(first_ray_.back() + ray_count(sender, head_));
      }
    }
    in.expect_end();
    if (!colors_[head_.pass]) colors_[head_.pass].emplace(zones_.scene(head_.pass), zones_.map());
  }

  ZoneItemResult work(uint64_t first, uint64_t count, const std::function<void()>& pulse) override {
    const uint64_t units = head_.kind == ZoneStageKind::light
                               ? zones_.map().cell_count() + zones_.media().cell_count()
                           : head_.kind == ZoneStageKind::mirrors ? mirrors_.count()
                                                                  : first_ray_.back();
    if (first > units || count > units - first) throw std::runtime_error("zones have no such units");
    ZoneItemResult result;
    result.bytes =
        head_.kind == ZoneStageKind::light
            ? measure_light(zones_, scene(), colors(), sampler_, settings_, first, count, pulse, result.rays)
            : send_rays(first, count, pulse, result.rays);
    return result;
  }

 private:
  const Scene& scene() const { return zones_.scene(head_.pass); }
  const ZoneColors& colors() const { return *colors_[head_.pass]; }

  LitSurface look_at(const ZonePoint& point, const Vec3& to_source, double choice) const {
    return rayfarm::look_at(scene(), zones_.map(), point.surface, point.hit, to_source, choice);
  }
  double choice_of(const SampleId& id) const { return sampler_.point(id, dimension::of_mix(0)).x; }

  std::vector<std::byte> send_rays(uint64_t first, uint64_t count, const std::function<void()>& pulse,
                                   RayCounts& counts) {
    PowerTally tally(zones_.slot_count());
    PowerTracer tracer(scene(), zones_, colors(), sampler_, settings_, tally, counts);
    for (uint64_t unit = first; unit < first + count; ++unit) {
      if (head_.kind == ZoneStageKind::mirrors)
        send_from_mirror(mirrors_[unit], tracer, counts);
      else
        send_from_zone(unit, tracer, tally);
      if (unit % kRaysPerPulse == 0) pulse();
    }
    tracer.finish();
    PackedWriter out;
    out.power(tally.sent);
    out.power(tally.absorbed);
    out.power(tally.escaped);
    out.sums(tally.kept);
    out.sums(tally.direct);
    return out.take();
  }

  void send_from_mirror(const MirrorUnits::Unit& unit, PowerTracer& tracer, RayCounts& counts) {
    const ZoneMap& map = zones_.map();
    if (!(map.area(*unit.grid, unit.cell) > 0)) return;
    const PrimaryLight light(scene(), map, sampler_, settings_);
    const uint64_t cell = unit.grid->first_cell + uint64_t{unit.cell};
    light.for_each_arrival(
        *unit.grid, unit.cell, unit.side, counts,
        [&](const ZonePoint& point, uint32_t sample, const Arrival& arrival) {
          const SampleId id = PrimaryLight::id_of(cell, unit.side, sample);
          const LitSurface lit = look_at(point, arrival.to_source, choice_of(id));
          const Lobes followed = followed_lobes(unit.grid, lit.material, lit.at, lit.lobes);
          if (followed.empty()) return;
          const ScatteredRay next = rayfarm::sample(
              followed, lit.at, sampler_.point(id, dimension::of_bounce(1, dimension::kDirection)),
              sampler_.point(id, dimension::of_bounce(1, dimension::kLobe)).x);
          if (next.weight == Color(0) ||
              (glm::dot(lit.surface.geometric_normal, next.direction) > 0) == next.is_transmitted)
            return;
          PowerRay ray;
          ray.ray = {lit.surface.ray_origin(next.direction), next.direction};
          ray.power = head_.quantum.quantized(arrival.power * next.weight);
          ray.id = id;
          ray.depth = 2;
          if (next.is_transmitted && has_inside(lit.material))
            ray.media.cross(lit.surface.material, lit.surface.is_front);
          if (!ray.power.is_zero()) tracer.send(ray);
        });
  }

  /// The ray's share of what its zone has to send.
  void send_from_zone(uint64_t unit, PowerTracer& tracer, PowerTally& tally) {
    const auto found = std::upper_bound(first_ray_.begin(), first_ray_.end(), unit) - 1;
    const ZoneSender& sender = senders_->all()[static_cast<size_t>(found - first_ray_.begin())];
    const uint64_t number = unit - *found;
    const auto rays = static_cast<int64_t>(ray_count(sender, head_));
    PowerRay ray;
    ray.id = {static_cast<int>(sender.first_slot & 0x7fffffff),
              static_cast<int>(sender.first_slot >> 31 << 20 | (head_.round & 0xfffff)),
              static_cast<uint32_t>(number)};
    // Exactly its share, which is a quantum more for the first ones.
    const auto share = [&](const Power& of) {
      Power power;
      for (size_t c = 0; c < 3; ++c) power[c] = of[c] / rays + (std::cmp_less(number, of[c] % rays) ? 1 : 0);
      return power;
    };
    size_t index = sender.first;
    Power power = share(unsent_[index]);
    uint64_t slot = slots_[index];
    if (sender.count > 1) {
      // Warped by the power of directions, each in its own colour.
      Power all;
      for (size_t i = 0; i < sender.count; ++i) all += unsent_[sender.first + i];
      const double u = sampler_.point(ray.id, dimension::of_bounce(0, dimension::kLobe)).x;
      double left = (static_cast<double>(number) + u) / static_cast<double>(rays) * sender.power;
      while (index + 1 < sender.first + sender.count && left >= unsent_[index].total())
        left -= unsent_[index++].total();
      slot = slots_[index];
      power = share(all);
      ray.power =
          scaled(unsent_[index], Color(sender.power / static_cast<double>(rays) / unsent_[index].total()));
    } else {
      ray.power = power;
    }
    ray.is_direct = head_.kind == ZoneStageKind::emit;
    if (slot < zones_.map().slot_count())
      leave_surface(slot, ray);
    else
      leave_medium(slot - zones_.map().slot_count(), ray);
    Power lost = power;
    lost -= ray.power;
    tally.absorbed += lost;
    tally.sent += lost;
    tracer.send(ray);
  }

  void leave_surface(uint64_t slot, PowerRay& ray) const {
    const ZoneMap& map = zones_.map();
    const SlotPlace place = map.place_of_slot(slot);
    const ZoneGrid& grid = map.grids()[place.grid];
    const ZonePoint point = sample_zone(map, sampler_, settings_.seed, grid, place.cell, place.side, ray.id);
    Vec2 u = sampler_.point(ray.id, dimension::of_bounce(0, dimension::kDirection));
    if (place.direction > 0) {
      const uint32_t n = grid.store.direction_cells, cell = place.direction - 1;
      u = (Vec2(cell % n, cell / n) + u) / static_cast<double>(n);
    }
    const DirectionFrame frame(point.surface.geometric_normal, point.tangent);
    const Vec3 local = direction_at(u), direction = frame.to_world(local);
    ray.ray = {point.surface.ray_origin(direction), direction};
    if (place.direction == 0)
      ray.power = scaled(ray.power, Color(passed_by_polish(point, direction, ray.id)));
  }

  void leave_medium(uint64_t slot, PowerRay& ray) const {
    const MediumGrid& grid = zones_.media().grid_of_slot(slot);
    const uint64_t in_grid = slot - grid.first_slot, directions = grid.directions.count();
    const Vec3 p = zones_.media().point(grid, in_grid / directions, [&](uint32_t i) {
      const auto r = random_pair(settings_.seed, sampler_.frame(), ray.id, dimension::of_mix(i + 1));
      return Vec2(r[0], r[1]);
    });
    const Vec2 u = sampler_.point(ray.id, dimension::of_bounce(0, dimension::kDirection));
    ray.ray = {p, grid.directions.direction(static_cast<uint32_t>(in_grid % directions), u)};
  }

  /// What a substrate sends through its polish in a direction.
  double passed_by_polish(const ZonePoint& point, const Vec3& direction, const SampleId& id) const {
    if (!may_be_polished(scene().materials[point.surface.material])) return 1;
    return rayfarm::passed_by_polish(look_at(point, direction, choice_of(id)));
  }

  RenderSettings settings_;
  ZoneScene zones_;
  Sampler sampler_;
  MirrorUnits mirrors_;
  std::vector<std::optional<ZoneColors>> colors_;
  // Of the stage.
  ZoneStageHead head_;
  std::vector<uint64_t> slots_;  ///< that have something to send
  std::vector<Power> unsent_;    ///< of each
  std::optional<ZoneSenders> senders_;
  std::vector<uint64_t> first_ray_;  ///< of each sender
};

}  // namespace

std::unique_ptr<ZoneTracer> make_zonal_tracer(const Scene& scene, const RenderSettings& settings, int frame) {
  return std::make_unique<ZonalTracer>(scene, settings, frame);
}

}  // namespace rayfarm
