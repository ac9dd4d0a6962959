#include "common/hierarchy/ray_memory.h"

namespace rayfarm {

RayMemory& RayMemory::of_this_thread(const Scene& scene) {
  thread_local RayMemory memory;
  if (memory.scene_number_ != scene.tracing->number) {
    memory = {};
    memory.scene_number_ = scene.tracing->number;
    if (scene.head().ray_coherence > 0) memory.coherence = std::make_unique<RayCoherence>(scene);
  }
  return memory;
}

}  // namespace rayfarm
