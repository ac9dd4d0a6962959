#pragma once
// One step of those paths of a packet that all can take at once: of surfaces that only reflect diffusely and
// as mirrors, or let light through as glass.
#include "common/lighting/frame_context.h"
#include "common/lighting/integrators/path_lanes.h"

namespace rayfarm {

/// What became of the lanes of a step.
struct PathStep {
  LaneSet go_on = 0;                           ///< their rays are set
  LaneSet is_diffuse = 0, is_transmitted = 0;  ///< of those that go on
};

/// Parts of a step: light straight from a source, and the direction in which the path goes on.
enum class StepPart : uint8_t { both, light, direction };

/// What is common to a packet's paths.
struct PathStage {
  const FrameContext& context;
  std::span<const SampleId> ids;  ///< by place
  uint32_t depth = 1;
  bool is_risky = false;  ///< paths end by chance
  StepPart part = StepPart::both;
};

/// The step of `lanes`, which the sets above describe, or the part that the stage says. Emission and media
/// are the caller's.
PathStep step_in_lanes(const PathStage& stage, LaneSet lanes, PathLanes& paths, ShadowLanes& shadows);

/// The power heuristic for one sample of each of two densities (Veach 1997, section 9.2.4).
inline double balance(double used, double other) {
  const double ratio = other / used;
  return 1 / (1 + ratio * ratio);
}

}  // namespace rayfarm
