#include "common/hierarchy/mailbox.h"

namespace rayfarm {

Mailbox& Mailbox::of_this_thread() {
  thread_local Mailbox mailbox;
  return mailbox;
}

uint64_t Mailbox::begin_search(const Scene& scene) {
  const size_t triangles = 8 * scene.triangle_blocks.size(), spheres = 8 * scene.sphere_blocks.size(),
               all = triangles + spheres + scene.leaf_primitives.size();
  first_ = {0, triangles, triangles + spheres};
  if (last_search_.size() < all) last_search_.resize(all);
  return ++searches_;
}

}  // namespace rayfarm
