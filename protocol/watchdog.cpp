#include "protocol/watchdog.h"

#include <signal.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

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

Watchdog::Watchdog() : thread_([this] { watch(); }) {}

Watchdog::~Watchdog() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Watchdog::arm(double seconds, std::string message) {
  const std::lock_guard lock(mutex_);
  deadline_ =
      std::chrono::steady_clock::now() +
      std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(seconds));
  message_ = std::move(message);
  is_armed_ = true;
  changed_.notify_all();
}

void Watchdog::disarm() {
  const std::lock_guard lock(mutex_);
  is_armed_ = false;
  changed_.notify_all();
}

void Watchdog::watch() {
  std::unique_lock lock(mutex_);
  while (!is_ending_) {
    if (!is_armed_) {
      changed_.wait(lock);
    } else if (changed_.wait_until(lock, deadline_) == std::cv_status::timeout && is_armed_ &&
               std::chrono::steady_clock::now() >= deadline_) {
      std::fprintf(stderr, "rayfarm: %s\n", message_.c_str());
      std::fflush(nullptr);
      end_job(1);
    }
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
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/" + std::to_string(pid) + "/exe", error);
  if (!error && program == std::filesystem::read_symlink("/proc/self/exe", error))
    kill(static_cast<pid_t>(pid), SIGKILL);
}

}  // namespace rayfarm
