#pragma once
#include <stop_token>
#include <thread>

namespace rayfarm {

/// From now on Ctrl-C, SIGTERM and SIGHUP ask the host to stop; a second one ends the process at once.
/// A closed pipe on stdout or stderr ends nothing.
void catch_interrupts();
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
