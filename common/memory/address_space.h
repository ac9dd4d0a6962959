#pragma once

namespace rayfarm {

/// Where the address space is limited (`ulimit -v`), all threads share one heap: glibc would reserve 64 MiB
/// of addresses or more for each thread that allocates, and whether a scene fits would depend on which do.
/// (Close to the least that a scene needs it still may, by the stacks of threads.) To be called before there
/// are threads.
void share_heap_if_limited();

}  // namespace rayfarm
