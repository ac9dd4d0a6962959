#pragma once
// Rays that leave surfaces without an epsilon (Shirley, Sung and Brown 1991, section 3.1 and Figure 5). A
// surface stands between what is behind its outward normal and what is before it, and a ray knows what it is
// in; so "a dot product of the ray direction with the normal of a surface will tell the ray which material is
// in front of the surface from the point of view of the ray. If this material is not the same as the material
// the ray is traveling through, then the ray cannot hit that surface": at no distance. What is behind a
// surface is its own material, opaque or not; before it there may be anything else. So a ray meets a front
// if it is not in that material, a back if it is: and never the surface that it leaves, from exactly where it
// was hit. Sheets have no inside: theirs are met from both sides, and left by a bound on rounding as ever.
#include <array>

#include "common/lighting/frame_context.h"
#include "common/lighting/media.h"
#include "common/lighting/surfaces.h"

namespace rayfarm {

inline bool is_by_medium(const FrameContext& context) {
  return context.tables.settings.self_hit == SelfHit::medium;
}

/// Of a surface's declared material: it has two sides and nothing between them (translucent), or it is one of
/// several wherever a ray meets it (mix), or nothing (holes.h).
bool is_sheet(const Material& material);

/// What each ray of a packet is in.
using MediaOfRays = std::array<const Media*, kMostPacketRays>;

/// The closest hit in (0, ray.t_max] that the ray can have in `media`. `first`: the closest of all. A ray
/// that can't hit the first thousand has none.
Hit next_real_hit(const FrameContext& context, const Ray& ray, const Media& media, const Hit& first);
/// Puts those in the place of the packet's closest hits.
void keep_real_hits(const FrameContext& context, const RayPacket& rays, const MediaOfRays& media, Hit* hits);
/// As any_hits: of the rays of `among`, those that hit anything they can hit.
uint32_t any_real_hits(const FrameContext& context, const RayPacket& rays, const MediaOfRays& media,
                       uint32_t among);

// Surfaces are handed over as copies: those whose address others have can't be kept in registers, though
// these are seldom called.

/// Rays leave bodies from exactly where they are hit.
Surface laid_on_surface(const Scene& scene, Surface surface);
/// The same of those surfaces of a packet that rays `met`.
void lay_on_surfaces(const Scene& scene, uint32_t met, Surfaces& surfaces);

/// The media of a ray that leaves a surface, which a ray in `media` met.
void leave(const Scene& scene, Surface surface, const Vec3& direction, Media& media);

/// What the eye is in: the bodies of which the ray through the picture's middle meets backs and, before, no
/// fronts.
Media find_eye_media(const Scene& scene, const Pose& pose, const Ray& middle);

}  // namespace rayfarm
