#include "common/memory/address_space.h"

#include <malloc.h>
#include <sys/resource.h>

namespace rayfarm {

void share_heap_if_limited() {
#ifdef __GLIBC__
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY) mallopt(M_ARENA_MAX, 1);
#endif
}

}  // namespace rayfarm
