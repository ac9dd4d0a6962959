#pragma once
// Rays that carry power from zones to zones (Shirley, Sung and Brown 1991, section 3), several at a time.
#include "common/lighting/media.h"
#include "common/lighting/ray_counts.h"
#include "common/lighting/zones/kept_light.h"
#include "common/lighting/zones/power.h"
#include "common/lighting/zones/zone_scene.h"
#include "common/sampling/sampler.h"
#include "common/scene/render_settings.h"

namespace rayfarm {

/// What rays gave.
struct PowerTally {
  explicit PowerTally(uint64_t slots) : kept(slots), direct(slots) {}
  PowerSums kept;
  PowerSums direct;  ///< of that, what came straight from where it began, if that is asked for
  Power sent, absorbed, escaped;
};

struct PowerRay {
  Ray ray;
  Power power;
  SampleId id;  ///< of its random numbers
  Media media{};
  uint32_t depth = 1;      ///< how often it has met a surface, and that
  bool is_direct = false;  ///< where it is kept at once, that is written down apart
};

class PowerTracer {
 public:
  /// All must outlive it. `scene`: in a pass's colours.
  PowerTracer(const Scene& scene, const ZoneScene& zones, const ZoneColors& colors, const Sampler& sampler,
              const RenderSettings& settings, PowerTally& tally, RayCounts& counts)
      : scene_(scene),
        map_(zones.map()),
        media_(zones.media()),
        colors_(colors),
        sampler_(sampler),
        settings_(settings),
        tally_(tally),
        counts_(counts) {}

  /// Takes a ray; it may be traced later. What it carries counts as sent.
  void send(const PowerRay& ray);
  /// Traces what is left.
  void finish();

 private:
  void step();
  bool meet(PowerRay& ray, const Hit& hit);
  /// Leaves with the zones of media what they take out of a ray on its way to `t`.
  void cross_media(PowerRay& ray, double t);
  /// What a cell scatters of light in the ray's direction.
  void keep_in_medium(const PowerRay& ray, const MediumGrid& grid, uint64_t cell, const Power& power);
  /// False: it ends.
  bool follow(PowerRay& ray, const Surface& surface, const Interaction& at, const Material& material,
              const Lobes& followed, Power& left);

  const Scene& scene_;
  const ZoneMap& map_;
  const MediumZones& media_;
  const ZoneColors& colors_;
  const Sampler& sampler_;
  const RenderSettings& settings_;
  PowerTally& tally_;
  RayCounts& counts_;
  InlineVector<PowerRay, kMostPacketRays> rays_;
};

/// The lobes along which power goes on from a surface: those that its zones, if it has any, do not keep.
/// Attenuations become parts of power: radiance is squeezed behind a denser surface, power is not.
Lobes followed_lobes(const ZoneGrid* grid, const Material& material, const Interaction& at,
                     const Lobes& lobes);

}  // namespace rayfarm
