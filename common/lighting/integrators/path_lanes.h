#pragma once
// A packet of paths as structure of arrays, and one step of those that all can take at once: of surfaces that
// only reflect diffusely and as mirrors, or let light through as glass. What is written of lanes in a set is
// bit i for lane i.
#include "common/lighting/frame_context.h"

namespace rayfarm {

using LaneSet = uint32_t;

/// A vector of each lane.
using Vec3Columns = double[3][kMostPacketRays];
inline Vec3 vec3_at(const Vec3Columns& columns, size_t lane) {
  return {columns[0][lane], columns[1][lane], columns[2][lane]};
}
inline void set_vec3(Vec3Columns& columns, size_t lane, const Vec3& v) {
  columns[0][lane] = v.x;
  columns[1][lane] = v.y;
  columns[2][lane] = v.z;
}

/// What a step in lanes takes and gives.
struct alignas(64) PathColumns {
  // Of each path.
  Vec3Columns throughput;
  double pdf[kMostPacketRays];  ///< of the last direction; 0: only chance could have led here, as along a
                                ///< mirror's
  uint64_t pixel_keys[kMostPacketRays];        ///< of the Sampler
  uint32_t reversed_samples[kMostPacketRays];  ///< the samples' numbers with their bits reversed
  uint32_t places[kMostPacketRays];            ///< of the eye rays
  Vec3Columns origin, direction;               ///< of its ray

  // Of the surface that it meets.
  Vec3Columns p, geometric_normal, shading_normal;
  double offset[kMostPacketRays];

  // Of the material there. What the lobes' sets leave out is never read.
  double index_ratio[kMostPacketRays];  ///< of dielectrics and classical surfaces behind over before; of a
                                        ///< polish
  Vec3Columns substrate;                ///< what is reflected diffusely, under a polish or bare
  Vec3Columns n, k;                     ///< of conductors
  double reflect[kMostPacketRays], transmit[kMostPacketRays];  ///< of classical surfaces
  Vec3Columns through;                                         ///< what classical surfaces transmit
  uint32_t materials[kMostPacketRays];                         ///< which of the scene's
  LaneSet is_front;
  LaneSet substrates, polished, conductors, dielectrics, classical;
  LaneSet can_reflect, can_transmit;  ///< not yet as often as is allowed

  void clear_sets() {
    is_front = substrates = polished = conductors = dielectrics = classical = can_reflect = can_transmit = 0;
  }

  /// From one lane to another, with its ray.
  void move_path(size_t from, size_t to) {
    for (size_t axis = 0; axis < 3; ++axis) {
      throughput[axis][to] = throughput[axis][from];
      direction[axis][to] = direction[axis][from];
    }
    pdf[to] = pdf[from];
    pixel_keys[to] = pixel_keys[from];
    reversed_samples[to] = reversed_samples[from];
    places[to] = places[from];
  }
};

/// Shadow rays of a step, and what each brings if nothing is in its way.
struct alignas(64) ShadowColumns {
  Vec3Columns origin, to_target, color;
};

/// What became of the lanes of a step.
struct PathStep {
  LaneSet go_on = 0;                           ///< their rays are set
  LaneSet is_diffuse = 0, is_transmitted = 0;  ///< of those that go on
  LaneSet has_shadow = 0;
};

/// What is common to a packet's paths.
struct PathStage {
  const FrameContext& context;
  std::span<const SampleId> ids;  ///< by place
  uint32_t depth = 1;
  bool is_risky = false;  ///< paths end by chance
};

/// The step of `lanes`, which the sets above describe: light straight from a source, and the direction in
/// which the path goes on. Emission and media are the caller's.
PathStep step_in_lanes(const PathStage& stage, LaneSet lanes, PathColumns& paths, ShadowColumns& shadows);

/// The power heuristic for one sample of each of two densities (Veach 1997, section 9.2.4).
inline double balance(double used, double other) {
  const double ratio = other / used;
  return 1 / (1 + ratio * ratio);
}

}  // namespace rayfarm
