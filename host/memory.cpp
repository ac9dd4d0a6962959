#include "host/memory.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

namespace rayfarm {
namespace {

constexpr uint64_t kUnlimited = std::numeric_limits<uint64_t>::max();

/// What /proc/meminfo says is free or can be made so.
uint64_t machine_bytes() {
  std::ifstream file("/proc/meminfo");
  uint64_t kibibytes = 0;
  for (std::string name, line; file >> name && std::getline(file, line);)
    if (name == "MemAvailable:") kibibytes = std::stoull(line);
  return kibibytes ? kibibytes << 10 : kUnlimited;
}

uint64_t read_number(const std::string& path) {
  std::ifstream file(path);
  uint64_t number = 0;
  return file >> number ? number : kUnlimited;  // "max" is no number
}

/// What this process's control group (version 2) leaves.
uint64_t group_bytes() {
  std::ifstream file("/proc/self/cgroup");
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("0::")) continue;
    const std::string folder = "/sys/fs/cgroup" + line.substr(3);
    const uint64_t most = read_number(folder + "/memory.max"), used = read_number(folder + "/memory.current");
    if (most != kUnlimited && used != kUnlimited) return most - std::min(used, most);
  }
  return kUnlimited;
}

/// What the limit on address space (ulimit -v) leaves.
uint64_t address_bytes() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return kUnlimited;
  const uint64_t pages = read_number("/proc/self/statm");
  const uint64_t used = pages == kUnlimited ? 0 : pages * static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
  return limit.rlim_cur - std::min<uint64_t>(used, limit.rlim_cur);
}

}  // namespace

uint64_t available_memory_bytes() {
  return std::min({machine_bytes(), group_bytes(), address_bytes()});
}

}  // namespace rayfarm
