#include "common/parallel/parallel_for.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace rayfarm {

size_t core_count() {
  return std::max(1u, std::thread::hardware_concurrency());
}

void parallel_for(size_t count, const std::function<void(size_t)>& step) {
  std::atomic<size_t> next = 0, end = count;
  std::mutex mutex;
  std::exception_ptr first;
  const auto work = [&] {
    for (size_t i; (i = next.fetch_add(1)) < end.load();) {
      try {
        step(i);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (i < end.load()) {  // steps are taken in order: those before this one run, or have
          end.store(i);
          first = std::current_exception();
        }
      }
    }
  };
  {
    std::vector<std::jthread> others;
    try {
      for (size_t i = 1; i < std::min(count, core_count()); ++i) others.emplace_back(work);
    } catch (const std::system_error&) {  // no more threads: those that are there do it
    }
    work();
  }
  if (first) std::rethrow_exception(first);
}

}  // namespace rayfarm
