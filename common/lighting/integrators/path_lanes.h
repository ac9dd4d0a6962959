#pragma once
// A packet of paths as structure of arrays: what a step in lanes works on.
#include "common/lighting/media.h"
#include "common/lighting/surfaces.h"

namespace rayfarm {

/// Bit i: lane i.
using LaneSet = uint32_t;

struct alignas(64) PathLanes {
  PathLanes() {}  // leaves the lanes as they are

  RayPacket rays;
  // Of each path.
  VectorLanes throughput;
  double pdf[kMostPacketRays];  ///< of the last direction; 0: only chance could have led here, as along a
                                ///< mirror's
  uint64_t pixel_keys[kMostPacketRays];        ///< of the Sampler
  uint32_t reversed_samples[kMostPacketRays];  ///< the samples' numbers with their bits reversed
  uint32_t places[kMostPacketRays];            ///< of the eye rays

  Surfaces surfaces;  ///< that they meet
  // Of the material there. Lanes outside the sets mean nothing.
  alignas(
      64) double index_ratio[kMostPacketRays];  ///< behind the surface over before it; of a polish over air
  VectorLanes substrate;                        ///< what is reflected diffusely, under a polish or bare
  VectorLanes n, k;                             ///< of conductors
  double reflect[kMostPacketRays], transmit[kMostPacketRays];  ///< of classical surfaces
  VectorLanes through;                                         ///< what classical surfaces transmit
  LaneSet substrates, polished, conductors, dielectrics, classical;
  LaneSet can_reflect, can_transmit;  ///< not yet as often as is allowed

  void clear_sets();
  /// Describes what a lane's surface is made of. False, with the sets as they were, if that is not for a step
  /// in lanes: it has a texture or spread highlights, shines, or is of another family.
  bool set_material(const Scene& scene, size_t lane, const Media& media);
  /// Leaves the paths of these lanes, close together; their rays go as far as they can.
  void keep(LaneSet lanes);
};

/// Shadow rays of a step, and what each brings if nothing is in its way.
struct alignas(64) ShadowLanes {
  ShadowLanes() {}
  RayPacket rays;
  VectorLanes colors;
  uint32_t places[kMostPacketRays];  ///< of the paths' eye rays

  void push_back(const Vec3& origin, const Vec3& to_target, const Color& color, uint32_t place) {
    set_lane(colors, rays.size, color);
    places[rays.size] = place;
    rays.push_back(origin, to_target, 1);
  }
};

}  // namespace rayfarm
