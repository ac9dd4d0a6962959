#pragma once
// What stays the same for all rays of one moment.
#include "common/lighting/diffuse_directions.h"
#include "common/lighting/surface.h"
#include "common/sampling/sampler.h"

namespace rayfarm {

/// What is laid out once for all rays.
struct SamplingTables {
  SamplingTables(const RenderSettings& with, int frame)
      : settings(with),
        sampler(with, frame),
        diffuse_directions(with.lighting == LightingModel::thesis
                               ? with.diffuse_rays * samples_that_share_directions(with)
                               : 0) {}

  /// The thesis spreads one set of diffuse rays over all the samples of a pixel; four for rays through
  /// corners, each of which four pixels share.
  static uint32_t samples_that_share_directions(const RenderSettings& settings) {
    return settings.sampling == SamplingPattern::corners ? 4 : settings.samples;
  }

  const RenderSettings& settings;
  Sampler sampler;
  DiffuseDirections diffuse_directions;
};

/// Of diffuse rays, as wide as a few dozen of them are apart.
constexpr double kDiffuseSpread = 0.1;

struct FrameContext {
  const Scene& scene;
  const Pose& pose;
  const SamplingTables& tables;
  double spread = 0;  ///< of eye rays: how much wider a pixel's cone gets with each unit of length
};

}  // namespace rayfarm
