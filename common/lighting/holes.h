#pragma once
// Surfaces that are not there everywhere: a material's opacity, which a texture may give, and backs that only
// their front shows. A ray goes on through a hole with its origin, its depth and the density of its
// direction, as if nothing had been there; where opacity is between 0 and 1, it does so with that
// probability. Shadow rays lose that share.
#include "common/lighting/frame_context.h"
#include "common/lighting/media.h"

namespace rayfarm {

inline bool has_holes(const FrameContext& context) {
  return context.scene.head().has_holes != 0;
}

/// The share of light that passes where a ray met the surface. `width`: of the ray's cone there.
double open_share(const FrameContext& context, const Ray& ray, const Hit& hit, const Surface& surface,
                  double width);

/// What tells a ray's random numbers from others', and how wide its cone is.
struct RayThroughHoles {
  const SampleId& id;
  uint32_t stream = 0;
  double width = 0, spread = 0;
  const Media* media = nullptr;  ///< that the ray is in, where it has to know
};

/// The closest hit that is no hole. `first`: the closest of all.
Hit next_solid_hit(const FrameContext& context, const Ray& ray, const RayThroughHoles& through,
                   const Hit& first);

/// What is left of light along a shadow ray that something is in the way of.
double light_through_holes(const FrameContext& context, const Ray& ray, const Media* media);

}  // namespace rayfarm
