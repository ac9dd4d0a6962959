#pragma once
// What zones hold against what paths find that end all over them.
#include "common/scene/render_settings.h"
#include "common/scene/scene.h"

namespace rayfarm {

struct MeansOfZones {
  double rms = 0;    ///< over the mean
  double noise = 0;  ///< of the paths, the same way
  int zones = 0;     ///< sides of zones that have light
};
/// `samples`: paths of each zone.
MeansOfZones compare_zone_means(const Scene& scene, const RenderSettings& settings, uint32_t samples);

}  // namespace rayfarm
