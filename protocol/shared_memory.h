#pragma once
// Memory for the scene on a machine: shared by its processes, or a process's own. Large pages (2 MiB) are
// asked for in both, as rays wander through all of it. The system gives them for a process's own memory where
// /sys/kernel/mm/transparent_hugepage/enabled is `madvise` or `always`, and for shared memory only where
// /dev/shm is mounted for it (`mount -o remount,huge=advise /dev/shm`), which few machines are. Where it
// refuses, pages are small, and nothing else changes.
#include <cstddef>
#include <cstdint>

namespace rayfarm {

/// True if /dev/shm has room for so much.
bool shared_memory_seems_to_hold(uint64_t bytes);

/// Takes all pages of shared memory now, so that none is missing when it is written: that would end the
/// process with SIGBUS. False if they are not there.
bool claim_shared_memory(std::byte* memory, size_t bytes);

/// A process's own, to be given back by std::free. Throws std::bad_alloc. As allocate_large of common/memory,
/// which protocol, below all rooms, may not include; large pages from one page on, for a process holds one
/// such block and not many arrays.
std::byte* allocate_pages(size_t bytes);

}  // namespace rayfarm
