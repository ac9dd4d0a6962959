#pragma once
// Arrays as large as a scene. The system hands out memory in pages of 4 KiB, each at its first use and
// zeroed: a quarter of a million interruptions a GiB, and as many entries for the processor to look up while
// rays wander through it. Large arrays ask for pages of 2 MiB (Linux: transparent huge pages, where
// /sys/kernel/mm/transparent_hugepage/enabled is `madvise` or `always`; where not, nothing changes).
#include <algorithm>
#include <cstddef>
#include <vector>

namespace rayfarm {

/// Memory aligned to 64 bytes, to be given back by std::free. Throws std::bad_alloc. Any thread.
void* allocate_large(size_t bytes);
/// std::free, here so that all who include this header need no other.
void free_large(void* memory);

/// Gives whole pages of such memory back to the system: their contents are lost, and what is read there or
/// written is new.
void release_pages(void* begin, size_t bytes);

/// Grows an array's room to hold `more` elements, exactly where they are many.
template <typename Vector>
void make_room(Vector& array, size_t more) {
  if (array.size() + more > array.capacity())
    array.reserve(std::max(array.size() + more, array.size() + array.size() / 2));
}

/// For containers: as std::allocator, but of allocate_large.
template <typename T>
struct LargeAllocator {
  using value_type = T;
  LargeAllocator() = default;
  template <typename U>
  LargeAllocator(const LargeAllocator<U>&) {}
  T* allocate(size_t count) { return static_cast<T*>(allocate_large(count * sizeof(T))); }
  void deallocate(T* memory, size_t) { free_large(memory); }
  friend bool operator==(const LargeAllocator&, const LargeAllocator&) { return true; }
};

template <typename T>
using LargeVector = std::vector<T, LargeAllocator<T>>;

}  // namespace rayfarm
