#pragma once
// Light that comes to zones straight from sources, by shadow rays: "primary light sources are treated apart"
// (the thesis's 2.2.5, of Nishita and Nakamae), so that sources of any kind will do.
#include <algorithm>
#include <optional>

#include "common/lighting/ray_counts.h"
#include "common/lighting/zones/lit_surface.h"
#include "common/lighting/zones/medium_zones.h"
#include "common/lighting/zones/zone_map.h"
#include "common/materials/scattering.h"
#include "common/sampling/sampler.h"
#include "common/scene/render_settings.h"

namespace rayfarm {

/// What comes to a point of a zone.
struct Arrival {
  Vec3 to_source{0};  ///< unit
  Color power{0};     ///< the point's share of the zone's
  /// Shadow rays of pictures do not ask where it comes from: a background without an image, or luminous
  /// bodies that are found by chance alone.
  bool is_by_chance = false;
};

/// True if zones shoot what the source emits, if that is asked for: its light leaves evenly.
bool is_shot(const Scene& scene, const ZoneSettings& settings, const Light& light);

class PrimaryLight {
 public:
  /// All must outlive it. `scene`: in a pass's colours.
  PrimaryLight(const Scene& scene, const ZoneMap& map, const Sampler& sampler, const RenderSettings& settings)
      : scene_(scene),
        map_(map),
        sampler_(sampler),
        settings_(settings),
        has_chance_(scene.head().background != Color(0) ||
                    std::any_of(scene.materials.begin(), scene.materials.end(), is_luminaire)) {}

  /// The random numbers of a point: of a side of a cell.
  static SampleId id_of(uint64_t cell, uint32_t side, uint32_t sample) {
    return {static_cast<int>(cell), -1 - static_cast<int>(side), sample};
  }
  ZonePoint point(const ZoneGrid& grid, uint32_t cell, uint32_t side, uint32_t sample) const;
  /// Calls visit(arrival) for what comes to points of a medium's cell from all round: power is what the cell
  /// scatters of it. `cell`: among the grid's.
  template <typename Visit>
  void for_each_arrival(const MediumZones& media, const MediumGrid& grid, uint64_t cell, RayCounts& counts,
                        Visit visit) const {
    for (uint32_t sample = 0; sample < settings_.zones.samples; ++sample) {
      const SampleId id = id_of(map_.cell_count() + grid.first_cell + cell, 0, sample);
      const Vec3 p = media.point(grid, cell, [&](uint32_t i) {
        const auto r = random_pair(settings_.seed, sampler_.frame(), id, dimension::of_mix(i + 1));
        return Vec2(r[0], r[1]);
      });
      const Color share = grid.volume() / settings_.zones.samples * media.density(grid.first_cell + cell) *
                          scene_.media[grid.medium].scattering;
      if (const auto arrival = ask_source_in_medium(id, p, share, counts)) visit(sample, *arrival);
      for (uint32_t k = 0; has_chance_ && k < kRaysByChance; ++k)
        if (const auto arrival = ask_by_chance_in_medium({id.x, id.y, kRaysByChance * sample + k}, p,
                                                         share / static_cast<double>(kRaysByChance), counts))
          visit(sample, *arrival);
    }
  }
  /// Calls visit(point, sample, arrival) for what comes to the points of a cell's side: from one source by a
  /// shadow ray, and from where a ray leads that leaves by Lambert's law, each weighted by what the other may
  /// bring (Veach 1997, section 9.2.4).
  template <typename Visit>
  void for_each_arrival(const ZoneGrid& grid, uint32_t cell, uint32_t side, RayCounts& counts,
                        Visit visit) const {
    for (uint32_t first = 0; first < settings_.zones.samples; first += kMostPacketRays) {
      Asked asked;
      const uint32_t count = std::min<uint32_t>(kMostPacketRays, settings_.zones.samples - first);
      for (uint32_t i = 0; i < count; ++i) asked.points.push_back(point(grid, cell, side, first + i));
      const double share = map_.area(grid, cell) / settings_.zones.samples;
      const SampleId id = id_of(grid.first_cell + uint64_t{cell}, side, first);
      ask_sources(id, share, counts, asked);
      if (has_chance_) ask_by_chance(id, share, counts, asked);
      for (const auto& [index, arrival] : asked.arrivals) visit(asked.points[index], first + index, arrival);
    }
  }

 private:
  /// From a point in a medium. What they look for is a small part of all round, and each ray is as good as a
  /// point of a surface has.
  static constexpr uint32_t kRaysByChance = 8;

  struct Answer {
    uint32_t point = 0;
    Arrival arrival;
  };
  struct Asked {
    InlineVector<ZonePoint, kMostPacketRays> points;
    InlineVector<Answer, 2 * kMostPacketRays> arrivals;
  };
  /// `first`: of the first point. `share`: of the zone's area that a point has.
  void ask_sources(const SampleId& first, double share, RayCounts& counts, Asked& asked) const;
  void ask_by_chance(const SampleId& first, double share, RayCounts& counts, Asked& asked) const;
  std::optional<Arrival> ask_source_in_medium(const SampleId& id, const Vec3& p, const Color& share,
                                              RayCounts& counts) const;
  std::optional<Arrival> ask_by_chance_in_medium(const SampleId& id, const Vec3& p, const Color& share,
                                                 RayCounts& counts) const;
  /// `density`: with which the ray's direction was chosen.
  Arrival emitted_at(const Ray& ray, const Hit& hit, double density) const;
  /// What media leave of light on its way.
  Color left_by_media(const Ray& ray) const {
    return scene_.media.empty() ? Color(1) : transmittance(scene_, ray);
  }

  const Scene& scene_;
  const ZoneMap& map_;
  const Sampler& sampler_;
  const RenderSettings& settings_;
  bool has_chance_;
};

}  // namespace rayfarm
