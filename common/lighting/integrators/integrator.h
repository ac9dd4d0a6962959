#pragma once
// What a ray from the eye sees: the lighting models, one a file, behind one interface. A new model is a file
// here, a value of LightingModel, and a line in make_integrator.
#include <memory>

#include "common/lighting/frame_context.h"
#include "common/lighting/ray_counts.h"

namespace rayfarm {

/// One lighting model. It keeps its lists from packet to packet, so that a thread needs its own.
class Integrator {
 public:
  virtual ~Integrator() = default;

  /// Sets `colors`, those seen along eye rays, best neighbours; `ids` tell which samples they are. A colour
  /// does not depend on the other rays of its packet. `counts` grows by every ray traced. Returns how many of
  /// the eye rays met an object.
  size_t trace(const FrameContext& context, const RayPacket& rays, std::span<const SampleId> ids,
               RayCounts& counts, Color* colors) {
    counts[RayKind::primary] += rays.size;
    return follow(context, rays, ids, counts, colors);
  }

 private:
  /// As trace, apart from counting the eye rays.
  virtual size_t follow(const FrameContext& context, const RayPacket& rays, std::span<const SampleId> ids,
                        RayCounts& counts, Color* colors) = 0;
};

std::unique_ptr<Integrator> make_integrator(LightingModel model);

/// What make_integrator chooses from; each stands in its model's file.
using MakeIntegrator = std::unique_ptr<Integrator>();
MakeIntegrator make_phong, make_torrance_sparrow, make_whitted, make_thesis, make_path;

/// make_path's model, every path by itself: what the tests compare with.
MakeIntegrator make_path_one_by_one;

}  // namespace rayfarm
