#pragma once
// The rendering equation without bias: paths that scatter as the materials do, a shadow ray to one source at
// each turn, both weighted by multiple importance sampling (Veach 1997), ended by Russian roulette. The
// reference for the other lighting models. Ambient light, their stand-in for what paths find, is left out.
#include "common/lighting/lighting_tree.h"

namespace rayfarm {

/// As trace_eye_rays.
size_t trace_paths(const FrameContext& context, std::span<const Ray> rays, std::span<const SampleId> ids,
                   RayCounts& counts, Color* colors);

}  // namespace rayfarm
