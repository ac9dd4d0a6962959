#pragma once
// What stays the same for all rays of one moment.
#include "common/lighting/diffuse_directions.h"
#include "common/lighting/surface.h"
#include "common/math/inline_vector.h"
#include "common/sampling/sampler.h"
#include "common/scene/render_settings.h"

namespace rayfarm {

/// Of each ray of a packet.
template <typename T>
using OfPacket = InlineVector<T, kMostPacketRays>;

/// What is laid out once for all rays.
struct SamplingTables {
  SamplingTables(const RenderSettings& with, int frame)
      : settings(with),
        sampler(with.sampler(), frame),
        diffuse_directions(diffuse_directions_of(with), with.diffuse_bands) {}

  const RenderSettings& settings;
  Sampler sampler;
  DiffuseDirections diffuse_directions;
};

/// Of diffuse rays, as wide as a few dozen of them are apart.
constexpr double kDiffuseSpread = 0.1;

class LightItems;
class Media;
class ZoneLight;

struct FrameContext {
  const Scene& scene;
  const Pose& pose;
  const SamplingTables& tables;
  double width = 0;   ///< of a pixel's cone where eye rays start
  double spread = 0;  ///< of eye rays: how much wider a pixel's cone gets with each unit of length
  const Hit* eye_hits = nullptr;  ///< of the packet of eye rays, where an item buffer has found them
  const LightItems* light_items = nullptr;
  const ZoneLight* zones = nullptr;  ///< where light is kept in zones
  const Media* eye_media = nullptr;  ///< that eye rays begin in, where they have to know; null: none
};

}  // namespace rayfarm
