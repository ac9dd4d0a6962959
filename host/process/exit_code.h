#pragma once
#include <array>
#include <stdexcept>
#include <string>
#include <utility>

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

/// What help and manual say of them.
inline constexpr std::array<std::pair<ExitCode, const char*>, 6> kExitCodeWords{{
    {kComplete, "all is done"},
    {kRenderFailure, "it failed (under mpirun any failure may be 1), or compared images differ"},
    {kUsageError, "the command line is wrong"},
    {kSceneError, "the scene, or a file that it names, is wrong or can't be read"},
    {kSomeFramesFailed, "some frames failed, the others are there"},
    {kStopped, "stopped by a signal or --max-time, cleanly; --resume goes on from there"},
}};

/// The job can't go on; the message says why.
class JobError : public std::runtime_error {
 public:
  JobError(int code, const std::string& problem) : std::runtime_error(problem), code_(code) {}
  int code() const { return code_; }

 private:
  int code_;
};

}  // namespace rayfarm
