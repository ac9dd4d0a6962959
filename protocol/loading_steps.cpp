#include "protocol/loading_steps.h"

#include <fmt/core.h>

#include <limits>

#include "protocol/protocol_error.h"
#include "protocol/time_limits.h"

namespace rayfarm {

void check_mpi(int code, const char* what) {
  if (code == MPI_SUCCESS) return;
  char text[MPI_MAX_ERROR_STRING];
  int length = 0;
  MPI_Error_string(code, text, &length);
  throw MpiError(fmt::format("{}: {}", what, std::string(text, static_cast<size_t>(length))));
}

int to_mpi_count(size_t n) {
  if (n > static_cast<size_t>(std::numeric_limits<int>::max()))
    throw MpiError("a message is longer than 2 GiB");
  return static_cast<int>(n);
}

LoadingSteps::LoadingSteps(Watchdog& watchdog, bool is_host, std::function<std::string()> names_the_gone)
    : watchdog_(watchdog), is_host_(is_host) {
  watchdog.set_witness(std::move(names_the_gone));
}

LoadingSteps::~LoadingSteps() {
  watchdog_.disarm();
  watchdog_.set_witness({});
}

void LoadingSteps::begin(const char* what) {
  watchdog_.arm(
      is_host_ ? liveness::kLoadingStep_s : liveness::kLoadingStepOfNodes_s,
      fmt::format("a process was lost while loading ({}); the job ends. Start it again, without the "
                  "machine that failed",
                  what));
}

}  // namespace rayfarm
