#include "protocol/shared_memory.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <new>

namespace rayfarm {
namespace {

/// MPI itself keeps buffers in shared memory.
constexpr uint64_t kSpareSharedMemory = 16 << 20;

constexpr size_t kLargePage = size_t{2} << 20;

void ask_for_large_pages(std::byte* memory, size_t bytes) {
  const size_t into_page =
      reinterpret_cast<uintptr_t>(memory) % static_cast<uintptr_t>(sysconf(_SC_PAGESIZE));
  if (bytes >= kLargePage) madvise(memory - into_page, bytes + into_page, MADV_HUGEPAGE);
}

}  // namespace

bool shared_memory_seems_to_hold(uint64_t bytes) {
  struct statvfs info {};
  if (statvfs("/dev/shm", &info) != 0) return false;
  return uint64_t{info.f_bavail} * info.f_frsize >= bytes + kSpareSharedMemory;
}

bool claim_shared_memory(std::byte* memory, size_t bytes) {
  ask_for_large_pages(memory, bytes);
  // The kernel writes them, and reports what a write of ours could not survive.
  const int zeros = open("/dev/zero", O_RDONLY | O_CLOEXEC);
  if (zeros < 0) return false;
  size_t done = 0;
  while (done < bytes) {
    const ssize_t n = read(zeros, memory + done, std::min<size_t>(bytes - done, 64 << 20));
    if (n <= 0 && errno != EINTR) break;
    if (n > 0) done += static_cast<size_t>(n);
  }
  close(zeros);
  return done == bytes;
}

std::byte* allocate_pages(size_t bytes) {
  const size_t alignment = bytes >= kLargePage ? kLargePage : 64;
  const size_t rounded = std::max(alignment, (bytes + alignment - 1) / alignment * alignment);
  auto* const memory = static_cast<std::byte*>(std::aligned_alloc(alignment, rounded));
  if (!memory) throw std::bad_alloc();
  ask_for_large_pages(memory, rounded);
  return memory;
}

}  // namespace rayfarm
