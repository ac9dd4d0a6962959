#pragma once

namespace rayfarm {

/// What the process returns. Under an mpirun that recovers from lost processes every code but 0 becomes 1.
enum ExitCode : int {
  kComplete = 0,
  kRenderFailure = 1,
  kUsageError = 2,
  kSceneError = 3,
  kSomeFramesFailed = 4,
  kStopped = 75,  ///< cleanly; start again with --skip-existing to go on
};

}  // namespace rayfarm
