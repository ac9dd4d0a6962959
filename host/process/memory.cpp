#include "host/process/memory.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
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

uint64_t read_number(const std::filesystem::path& path) {
  std::ifstream file(path);
  uint64_t number = 0;
  return file >> number ? number : kUnlimited;  // "max" is no number
}

/// Of a group's memory, what holds copies of files and goes when it is needed.
uint64_t file_cache_bytes(const std::filesystem::path& folder) {
  std::ifstream file(folder / "memory.stat");
  uint64_t bytes = 0, value = 0;
  for (std::string name; file >> name >> value;)
    if (name == "active_file" || name == "inactive_file") bytes += value;
  return bytes;
}

/// What this process's control group (version 2) and those above it leave.
uint64_t group_bytes() {
  const std::filesystem::path root = "/sys/fs/cgroup";
  std::ifstream file("/proc/self/cgroup");
  uint64_t least = kUnlimited;
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("0::/")) continue;
    for (std::filesystem::path group = root / line.substr(4);; group = group.parent_path()) {
      const uint64_t most = read_number(group / "memory.max"), used = read_number(group / "memory.current");
      if (most != kUnlimited && used != kUnlimited) {
        const uint64_t held = used - std::min(file_cache_bytes(group), used);
        least = std::min(least, most - std::min(held, most));
      }
      if (group == root || !group.has_relative_path()) break;
    }
  }
  return least;
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
