#pragma once
// What a thread remembers of the rays that it has traced, for those that come next: what the last one hit,
// and lists of what rays from a primitive can meet. No answer depends on it.
#include <memory>

#include "common/hierarchy/hit_place.h"
#include "common/hierarchy/ray_coherence.h"
#include "common/scene/tracing_state.h"

namespace rayfarm {

struct RayMemory {
  /// Threads have one each, so that nothing is shared. Of a scene with a TracingState; another scene's is
  /// forgotten.
  static RayMemory& of_this_thread(const Scene& scene);

  HitPlace closest;                         ///< what was hit first by the last ray that asked for it, and hit
  HitPlace occluder;                        ///< of the last shadow ray that was stopped
  std::unique_ptr<RayCoherence> coherence;  ///< null where no lists are asked for

 private:
  uint64_t scene_number_ = 0;
};

}  // namespace rayfarm
