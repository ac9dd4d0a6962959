#pragma once
// Ends this process when something that can't be interrupted, an MPI collective above all, makes no progress:
// with a dead process in it, it would wait for ever. A pause of this process does not count.
#include <functional>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>

namespace rayfarm {

class Watchdog {
 public:
  Watchdog();

  /// From now on `disarm` or another `arm` must come within `seconds`; else the message is printed to stderr
  /// and the whole job ends with exit code 1 (see end_job).
  void arm(double seconds, std::string message);
  void disarm();
  /// Asked a few times a second while armed, in the watchdog's thread: names a process that is known to be
  /// gone, which ends the job at once, or nothing.
  void set_witness(std::function<std::string()> names_the_gone);

 private:
  void watch(const std::stop_token& end);
  std::mutex mutex_;
  std::function<std::string()> names_the_gone_;
  double left_s_ = 0;
  std::string message_;
  bool is_armed_ = false;
  std::jthread thread_;
};

/// Ends this process at once with `code`, without waiting for any other. Under an mpirun that recovers from
/// lost processes the exit codes of its processes are ignored (Open MPI 4.1), so an mpirun on this machine is
/// told to end the job, which makes it return 1 for every code but 0.
[[noreturn]] void end_job(int code);

/// Ends a hung process of this job on this machine. A process that runs another program has only inherited
/// the number: it is left alone.
void end_hung_process(unsigned pid);

}  // namespace rayfarm
