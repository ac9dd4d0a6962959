#include "common/hierarchy/mailbox.h"

namespace rayfarm {

Mailbox& Mailbox::of_this_thread() {
  thread_local Mailbox mailbox;
  return mailbox;
}

Mailbox::Search Mailbox::begin_search(const Collection& c) {
  const size_t triangles = 8 * size_t{c.triangle_block_count}, spheres = 8 * size_t{c.sphere_block_count},
               all = triangles + spheres + c.leaf_primitive_count;
  if (last_search_.size() < all) last_search_.resize(all);
  return {++searches_,
          {0 - 8 * size_t{c.first_triangle_block}, triangles - 8 * size_t{c.first_sphere_block},
           triangles + spheres - c.first_leaf_primitive}};
}

}  // namespace rayfarm
