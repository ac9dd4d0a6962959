#pragma once
// The surfaces that the rays of a packet met, side by side.
#include "common/lighting/surface.h"

namespace rayfarm {

/// Of each ray of a packet; see Surface. Rays that met nothing have none.
struct Surfaces {
  Surfaces() {}  // leaves the lanes as they are
  alignas(64) VectorLanes p;
  alignas(64) VectorLanes geometric_normal;
  alignas(64) VectorLanes shading_normal;
  alignas(64) double offset[kMostPacketRays];
  uint32_t material[kMostPacketRays];
  uint32_t front = 0, gouraud = 0;  ///< bits of the rays

  bool is_front(size_t i) const { return front >> i & 1; }
  bool is_gouraud(size_t i) const { return gouraud >> i & 1; }
  Vec3 ray_origin(size_t i, const Vec3& direction) const {
    return rayfarm::ray_origin(lane_of(p, i), lane_of(geometric_normal, i), offset[i], direction);
  }
  Surface operator[](size_t i) const {
    return {lane_of(p, i),
            lane_of(geometric_normal, i),
            lane_of(shading_normal, i),
            is_front(i),
            is_gouraud(i),
            material[i],
            offset[i]};
  }
  void set(size_t i, const Surface& surface) {
    set_lane(p, i, surface.p);
    set_lane(geometric_normal, i, surface.geometric_normal);
    set_lane(shading_normal, i, surface.shading_normal);
    offset[i] = surface.offset;
    material[i] = surface.material;
    const uint32_t bit = 1u << i;
    front = surface.is_front ? front | bit : front & ~bit;
    gouraud = surface.is_gouraud ? gouraud | bit : gouraud & ~bit;
  }
};

/// As eval_surface, to the last bit, for all rays that hit: sets `surfaces`, and returns the bits of these
/// rays. hits[i] is of ray i.
uint32_t eval_surfaces(const Scene& scene, const Pose& pose, const RayPacket& rays, const Hit* hits,
                       Surfaces& surfaces);

}  // namespace rayfarm
