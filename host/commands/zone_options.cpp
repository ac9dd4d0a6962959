#include "host/commands/zone_options.h"

namespace rayfarm {

void add_zone_size_options(Options& options, ZoneSettings& zones) {
  options.number("--zone-size", zones.size, 1e-12, 1e12,
                 "how long the sides of zones may be, in the world, where the scene's `zones` says nothing "
                 "else (default: so that there are about 10,000)");
  options
      .number("--zone-memory", zones.most_GiB, 0.001, 1024,
              "GiB that zones and their sums may take on the host (default: 4)")
      .for_users();
}

void add_zone_options(Options& options, RenderOptions& o) {
  ZoneSettings& zones = o.settings.zones;
  add_zone_size_options(options, zones);
  options.number("--zone-rays", zones.rays, 1, kMostZoneRays,
                 "zonal: rays of the first round; later ones have as many for the same power. radiosity: "
                 "all that form factors by rays take (default: 1,000,000)");
  options.number("--zone-samples", zones.samples, 1, 65536,
                 "points of a zone at which light from sources is measured (default: 16)");
  options.number("--zone-batch", zones.batch, 1, 1 << 20, "rays that a node traces at a time (default: 4096)")
      .for_users();
  options.number("--zone-tolerance", zones.tolerance, 1e-9, 1,
                 "zonal: rounds end when this part of all power is unsent (default: 0.001)");
  options.choice<ZonePrimary>("--zone-primary", zones.primary, choices<ZonePrimary>(kZonePrimaryWords),
                              "zones measure light from all sources by shadow rays; or luminous zones send "
                              "what they emit as they send other light (default: direct)");
  options.choice<ZoneShooting>("--shoot", zones.shooting, choices<ZoneShooting>(kZoneShootingWords),
                               "zonal: all zones send in a round, or the one that has most to send (default: "
                               "all)");
  options.choice<FormFactors>("--form-factors", zones.form_factors, choices<FormFactors>(kFormFactorWords),
                              "radiosity: by rays from all over a zone, or by a hemicube about its middle "
                              "(default: rays)");
  options.number("--hemicube", zones.hemicube_cells, 2, 4096,
                 "radiosity: pixels along an edge of the hemicube's top (default: 64)");
  options
      .text("--zones", o.zones_file,
            "the file in which the light of zones is kept; if it is there nothing is computed again; #### "
            "becomes the frame number",
            "FILE")
      .for_users();
}

void add_zone_view_option(Options& options, RenderOptions& o) {
  options.choice<ZoneView>("--zone-view", o.settings.zones.view, choices<ZoneView>(kZoneViewWords),
                           "zones as they are; smoothed; smoothed, with light straight from sources by "
                           "shadow rays; or read by rays from each point that is seen (default: direct)");
  options.number("--gather-rays", o.settings.zones.gather_rays, 1, kMostGatherRays,
                 "of --zone-view gather: how many rays read zones from each point that is seen (default: 1)");
}

}  // namespace rayfarm
