#pragma once
// The lighting tree (thesis 2.3.4): what a ray sees, by the models of Phong (Equation 2.4), Torrance and
// Sparrow (2.2.3), Whitted (2.12) and the thesis (3.6a), with the depth and weight limits of Hall.
#include "common/lighting/frame_context.h"
#include "common/lighting/ray_counts.h"
#include "common/scene/render_settings.h"

namespace rayfarm {

/// The colours seen along up to kMostPacketRays eye rays, best neighbours, by the lighting model that the
/// settings name; `ids` tell which samples they are, `counts` grows by every ray traced. Returns how many of
/// the eye rays met an object.
size_t trace_eye_rays(const FrameContext& context, std::span<const Ray> rays, std::span<const SampleId> ids,
                      RayCounts& counts, Color* colors);

}  // namespace rayfarm
