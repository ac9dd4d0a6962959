#include "protocol/watchdog.h"

#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "protocol/liveness.h"
#include "protocol/time_limits.h"

namespace rayfarm {
namespace {

/// Processes that leave without ending MPI, and those that were killed, leave its buffers in shared memory
/// behind. A name that is gone disturbs nobody who has the memory mapped.
void remove_shared_buffers() {
  const char* job = std::getenv("PMIX_NAMESPACE");
  if (!job) return;
  char mark[32];
  std::snprintf(mark, sizeof mark, ".%lx.", std::strtoul(job, nullptr, 10));
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/dev/shm", error)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("vader_segment.") && name.find(mark) != std::string::npos)
      std::filesystem::remove(entry.path(), error);
  }
}

}  // namespace

Watchdog::Watchdog() : thread_([this](const std::stop_token& end) { watch(end); }) {}

void Watchdog::arm(double seconds, std::string message) {
  const std::lock_guard lock(mutex_);
  left_s_ = seconds;
  message_ = std::move(message);
  is_armed_ = true;
}

void Watchdog::disarm() {
  const std::lock_guard lock(mutex_);
  is_armed_ = false;
}

void Watchdog::set_witness(std::function<std::string()> names_the_gone) {
  const std::lock_guard lock(mutex_);
  names_the_gone_ = std::move(names_the_gone);
}

void Watchdog::watch(const std::stop_token& end) {
  std::condition_variable_any changed;
  std::unique_lock lock(mutex_);
  const auto end_because = [](const std::string& why) {
    std::fprintf(stderr, "rayfarm: %s\n", why.c_str());
    std::fflush(nullptr);
    end_job(1);
  };
  while (true) {
    changed.wait_for(lock, end, std::chrono::duration<double>(liveness::kLook_s), [] { return false; });
    if (end.stop_requested()) return;
    if (!is_armed_) continue;
    if (names_the_gone_)
      if (const std::string gone = names_the_gone_(); !gone.empty()) end_because(gone);
    left_s_ -= liveness::kLook_s;  // what was asked for: if the process was stopped, it was longer
    if (left_s_ <= 0) end_because(message_);
  }
}

void end_job(int code) {
  remove_shared_buffers();
  const char* recovery = std::getenv("OMPI_MCA_orte_enable_recovery");
  const char* rank = std::getenv("OMPI_COMM_WORLD_RANK");
  if (code != 0 && recovery && recovery[0] && std::strchr("1tTyY", recovery[0]) && rank) {
    std::string launcher;
    std::ifstream("/proc/" + std::to_string(getppid()) + "/comm") >> launcher;
    if (launcher == "mpirun" || launcher == "mpiexec" || launcher == "orterun" || launcher == "prterun") {
      signal(SIGTERM, SIG_IGN);  // mpirun passes it on; this process ends by itself
      kill(getppid(), SIGTERM);
    }
  }
  _exit(code);
}

void end_hung_process(unsigned pid) {
  if (runs_this_program(pid)) kill(static_cast<pid_t>(pid), SIGKILL);
}

}  // namespace rayfarm
