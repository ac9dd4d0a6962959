#pragma once
#include <stdexcept>
#include <string>

namespace rayfarm {

/// What the process returns. Under an mpirun that recovers from lost processes every code but 0 becomes 1.
enum ExitCode : int {
  kComplete = 0,
  kRenderFailure = 1,
  kUsageError = 2,
  kSceneError = 3,
  kSomeFramesFailed = 4,
  kStopped = 75,  ///< cleanly; start again with --resume to go on
};

/// The job can't go on; the message says why.
class JobError : public std::runtime_error {
 public:
  JobError(int code, const std::string& problem) : std::runtime_error(problem), code_(code) {}
  int code() const { return code_; }

 private:
  int code_;
};

}  // namespace rayfarm
