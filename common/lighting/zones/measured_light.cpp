#include "common/lighting/zones/measured_light.h"

#include <numbers>

#include "common/lighting/zones/lit_surface.h"
#include "common/lighting/zones/power_rays.h"
#include "common/lighting/zones/shooting.h"
#include "common/sampling/warps.h"

namespace rayfarm {
namespace {

/// What zones of one cell keep of the light straight from sources.
struct ZoneLit {
  explicit ZoneLit(uint64_t slots) : direct(slots, Color(0)), chance(slots, Color(0)) {}
  std::vector<Color>& kept(const Arrival& arrival) { return arrival.is_by_chance ? chance : direct; }
  std::vector<Color> direct, chance;  ///< by slot, from the cell's first
  Color followed{0};                  ///< of it, what goes on from the surface
};

struct LightMeter {
  const ZoneScene& zones;
  const Scene& scene;
  const ZoneColors& colors;
  const Sampler& sampler;
  const PrimaryLight& light;
  RayCounts& counts;

  ZoneLit measure_surface(uint64_t i) const {
    const ZoneMap& map = zones.map();
    const ZoneGrid& grid = map.grids()[map.grid_of_cell(i)];
    const auto cell = static_cast<uint32_t>(i - grid.first_cell);
    const uint64_t slots = 2 * grid.store.slots(), first_slot = grid.slot(cell, 0);
    ZoneLit result(slots);
    const bool is_seen = grid.store.is_any() || is_followed_at(scene, scene.materials[grid.material], grid);
    for (uint32_t side = 0; side < 2 && is_seen && map.area(grid, cell) > 0; ++side)
      light.for_each_arrival(
          grid, cell, side, counts, [&](const ZonePoint& point, uint32_t sample, const Arrival& arrival) {
            const SampleId id = PrimaryLight::id_of(i, side, sample);
            const LitSurface lit = look_at(scene, map, point.surface, point.hit, arrival.to_source,
                                           sampler.point(id, dimension::of_mix(0)).x);
            for (const Lobe& lobe : followed_lobes(&grid, lit.material, lit.at, lit.lobes))
              result.followed += arrival.power * lobe.attenuation;
            if (!grid.store.is_any()) return;
            KeptParts parts;
            find_kept(
                grid, cell, colors(grid, cell), lit.surface, lit.at, lit.lobes, point.tangent,
                [&](uint32_t k) {
                  return sampler.point({id.x, id.y, 16 * sample + k},
                                       dimension::of_bounce(1, dimension::kLightPoint));
                },
                parts);
            for (const KeptPart& part : parts)
              result.kept(arrival)[part.slot - first_slot] += arrival.power * part.fraction;
          });
    return result;
  }

  ZoneLit measure_medium(uint64_t i) const {
    const MediumGrid& grid = zones.media().grid_of_cell(i);
    const uint64_t cell = i - grid.first_cell;
    ZoneLit result(grid.directions.count());
    light.for_each_arrival(zones.media(), grid, cell, counts, [&](uint32_t sample, const Arrival& arrival) {
      if (grid.directions.rows == 0) {
        result.kept(arrival)[0] += arrival.power;
        return;
      }
      const SampleId id = PrimaryLight::id_of(zones.map().cell_count() + i, 0, sample);
      const Frame frame(-arrival.to_source);
      for (uint32_t k = 0; k < kSpreadRays; ++k) {
        const Vec2 u = sampler.point({id.x, id.y, kSpreadRays * sample + k},
                                     dimension::of_bounce(1, dimension::kLightPoint));
        const Vec3 local = sample_henyey_greenstein(u, scene.media[grid.medium].asymmetry);
        result.kept(arrival)[grid.directions.cell(frame.to_world(local))] +=
            arrival.power / double{kSpreadRays};
      }
    });
    return result;
  }
};

void write_lit(PackedWriter& out, const ZoneLit& lit) {
  uint64_t lit_slots = 0;
  for (uint64_t s = 0; s < lit.direct.size(); ++s)
    lit_slots += lit.direct[s] != Color(0) || lit.chance[s] != Color(0) ? 1 : 0;
  out.number(lit_slots);
  out.number(lit.followed == Color(0) ? 0 : 1);
  if (lit.followed != Color(0)) out.color(lit.followed);
  for (uint64_t s = 0; s < lit.direct.size(); ++s) {
    if (lit.direct[s] == Color(0) && lit.chance[s] == Color(0)) continue;
    out.number(s);
    out.color(lit.direct[s]);
    out.color(lit.chance[s]);
  }
}

}  // namespace

std::vector<std::byte> measure_light(const ZoneScene& zones, const Scene& scene, const ZoneColors& colors,
                                     const Sampler& sampler, const RenderSettings& settings, uint64_t first,
                                     uint64_t count, const std::function<void()>& pulse, RayCounts& counts) {
  const PrimaryLight light(scene, zones.map(), sampler, settings);
  const LightMeter meter{zones, scene, colors, sampler, light, counts};
  const uint64_t surfaces = zones.map().cell_count();
  PackedWriter out;
  for (uint64_t i = first; i < first + count; ++i) {
    write_lit(out, i >= surfaces ? meter.measure_medium(i - surfaces) : meter.measure_surface(i));
    pulse();
  }
  return out.take();
}

/// The first sum of a cell, and how many it has.
std::pair<uint64_t, uint64_t> MeasuredLight::slots_of_cell(uint64_t cell) const {
  const ZoneMap& map = zones_.map();
  if (cell < map.cell_count()) {
    const ZoneGrid& grid = map.grids()[map.grid_of_cell(cell)];
    return {grid.slot(static_cast<uint32_t>(cell - grid.first_cell), 0), 2 * grid.store.slots()};
  }
  const MediumGrid& grid = zones_.media().grid_of_cell(cell - map.cell_count());
  return {map.slot_count() + grid.slot(cell - map.cell_count() - grid.first_cell), grid.directions.count()};
}

void MeasuredLight::add(uint64_t item, std::span<const std::byte> result) {
  read(
      item, result, [](const Color&) {}, [](uint64_t, const Color&, const Color&) {});
  items_.emplace(item, std::vector(result.begin(), result.end()));
}

Color MeasuredLight::total() const {
  Color sum(0);
  for_each([&](const Color& followed) { sum += followed; },
           [&](uint64_t, const Color& direct, const Color& by_chance) { sum += direct + by_chance; });
  for (int c = 0; c < 3; ++c)
    if (!std::isfinite(sum[c])) throw std::runtime_error("zones get more light than numbers can tell");
  return sum;
}

std::vector<std::pair<uint64_t, Color>> find_shot(const ZoneScene& zones, const Scene& scene,
                                                  const ZoneSettings& settings) {
  std::vector<std::pair<uint64_t, Color>> shot;
  for (const Light& light : scene.lights) {
    if (!is_shot(scene, settings, light)) continue;
    Hit hit;
    hit.instance = light.instance;
    hit.primitive = light.primitive;
    const ZoneGrid* const grid = zones.map().grid_of(hit);
    if (!grid) continue;
    const Material& material = scene.materials[light.material];
    for (uint32_t cell = 0; cell < grid->cell_count; ++cell)
      shot.emplace_back(grid->slot(cell, material.is_inward),
                        std::numbers::pi * zones.map().area(*grid, cell) * material.emission);
  }
  return shot;
}

}  // namespace rayfarm
