#pragma once
#include <chrono>
#include <ctime>

namespace rayfarm {

/// Seconds of a clock that never goes back; only differences mean something.
inline double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Seconds since 1970.
inline double unix_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

/// Of one of the system's clocks.
inline double read_clock_s(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Processor time that this process, or thread, has used: other programs' work does not count.
inline double cpu_s() {
  return read_clock_s(CLOCK_PROCESS_CPUTIME_ID);
}
inline double thread_cpu_s() {
  return read_clock_s(CLOCK_THREAD_CPUTIME_ID);
}

}  // namespace rayfarm
