#include "protocol/watchdog.h"

#include <signal.h>
#include <unistd.h>

#include <chrono>
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

void Watchdog::watch() {
  constexpr std::chrono::duration<double> kStep(0.25);
  std::unique_lock lock(mutex_);
  const auto end = [](const std::string& why) {
    std::fprintf(stderr, "rayfarm: %s\n", why.c_str());
    std::fflush(nullptr);
    end_job(1);
  };
  while (!changed_.wait_for(lock, kStep, [this] { return is_ending_; })) {
    if (!is_armed_) continue;
    if (names_the_gone_)
      if (const std::string gone = names_the_gone_(); !gone.empty()) end(gone);
    left_s_ -= kStep.count();  // what was asked for: if the process was stopped, it was longer
    if (left_s_ <= 0) end(message_);
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
