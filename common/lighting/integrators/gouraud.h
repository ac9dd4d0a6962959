#pragma once
// Gouraud's shading (1971; thesis 2.3.5): the light at a polygon's corners, by the lighting model and the
// corners' normals, interpolated over it.
#include "common/lighting/integrators/classical_surfaces.h"

namespace rayfarm {

/// Adds to surface i the diffuse and specular light of all sources, as add_direct_light finds it at each
/// corner for the viewer from whom the ray came, shadow rays and all. Colours, textures and other rays are
/// the hit's. `counts` grows by the shadow rays.
void add_gouraud_light(const FrameContext& context, const Highlights& highlights, ClassicalSurfaces& surfaces,
                       size_t i, RayCounts& counts);

}  // namespace rayfarm
