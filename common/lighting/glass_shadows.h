#pragma once
// Shadow rays that go straight on through bodies that transmit light: the nonrefractive transparency of the
// thesis's section 2.2.4, and its shadows of glass that "many researchers omit" (3.5.1).
#include "common/lighting/frame_context.h"
#include "common/lighting/media.h"

namespace rayfarm {

/// Surfaces that a shadow ray crosses at most; it is blocked where there are more.
inline constexpr int kMostCrossings = 1000;

/// What is left of light along a shadow ray (t_max 1): nothing where something opaque is in its way; else all
/// of it (GlassShadows::none), or transmit × interior of every surface crossed, times what the filters of
/// dielectrics leave along the way (transparent). `is_blocked`: something is in its way, so that it is worth
/// looking what. `media`: those that the ray begins in.
Color light_through_glass(const FrameContext& context, Ray ray, bool is_blocked, Media media);

}  // namespace rayfarm
