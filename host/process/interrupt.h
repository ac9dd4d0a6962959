#pragma once
#include <stop_token>
#include <thread>

namespace rayfarm {

/// From now on Ctrl-C, SIGTERM and SIGHUP ask the host to stop; a second one ends the process at once, but
/// not under mpirun, which hands on what schedulers tell all processes anyway, and kills who is slow.
/// SIGUSR1, by which schedulers tell that time runs out, asks once. A closed pipe on stdout or stderr ends
/// nothing.
void catch_interrupts();
/// For processes that are told to stop by their host: SIGUSR1, which mpirun hands on to all, ends them not.
void leave_warnings_to_the_host();
/// As if SIGUSR1 came then.
void interrupt_after(double seconds);
/// The signal that asked the host to stop, or 0.
int interrupted_by();

/// Catches interrupts, and hands them on to work that looks at a stop token.
class StopOnInterrupt {
 public:
  StopOnInterrupt();
  std::stop_token token() const { return stop_.get_token(); }

 private:
  std::stop_source stop_;
  std::jthread watch_;  // last: it ends before what it sets
};

}  // namespace rayfarm
