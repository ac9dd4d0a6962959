#pragma once
// Collective steps of MPI while a job loads, in which a process that is lost would be waited for for ever.
#include <mpi.h>

#include <functional>
#include <string>

#include "protocol/watchdog.h"

namespace rayfarm {

/// Throws MpiError with the library's own words.
void check_mpi(int code, const char* what);
/// What MPI counts is an int. Throws MpiError.
int to_mpi_count(size_t n);

/// Some steps one after the other, each under the watchdog: a process lost meanwhile ends the job, at once if
/// `names_the_gone` (see Watchdog; may be empty) names it, else within kLoadingStepOfNodes_s.
class LoadingSteps {
 public:
  LoadingSteps(Watchdog& watchdog, bool is_host, std::function<std::string()> names_the_gone);
  /// However the steps ended, the watchdog does not end the job for them.
  ~LoadingSteps();
  LoadingSteps(const LoadingSteps&) = delete;
  LoadingSteps& operator=(const LoadingSteps&) = delete;

  /// `step` is a call of MPI, and gives its code.
  template <typename Step>
  void run(const char* what, Step step) {
    begin(what);
    check_mpi(step(), what);
    end();
  }
  /// A step that takes several calls; begun again, it may take as long again.
  void begin(const char* what);
  void end() { watchdog_.disarm(); }

 private:
  Watchdog& watchdog_;
  bool is_host_;
};

}  // namespace rayfarm
