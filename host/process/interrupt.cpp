#include "host/process/interrupt.h"

#include <signal.h>
#include <sys/time.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>

namespace rayfarm {
namespace {

std::atomic<int> caught{0};
static_assert(std::atomic<int>::is_always_lock_free);
/// Under mpirun one wish comes twice: Slurm sends it to all processes of a job, and mpirun, which has it too,
/// hands it on a second later. Who is impatient with mpirun is served by mpirun.
std::atomic<bool> may_be_impatient{true};

/// These say that time runs out: what comes after them is not yet impatience.
bool is_warning(int number) {
  return number == SIGUSR1 || number == SIGALRM;
}

void on_signal(int number) {
  int before = 0;
  if (caught.compare_exchange_strong(before, number) || is_warning(number)) return;
  if (is_warning(before) && caught.compare_exchange_strong(before, number)) return;
  if (may_be_impatient) _exit(128 + number);
}

}  // namespace

void catch_interrupts() {
  may_be_impatient = std::getenv("OMPI_COMM_WORLD_RANK") == nullptr;
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGALRM}) sigaction(number, &action, nullptr);
  // Who reads the text may leave: the pictures are written all the same.
  signal(SIGPIPE, SIG_IGN);
  signal(SIGXFSZ, SIG_IGN);  // a file beyond the limit (ulimit -f) is one that can't be written
}

void leave_warnings_to_the_host() {
  signal(SIGUSR1, SIG_IGN);
}

void interrupt_after(double seconds) {
  itimerval timer{};
  timer.it_value.tv_sec = static_cast<time_t>(seconds);
  timer.it_value.tv_usec = static_cast<suseconds_t>(1e6 * (seconds - std::floor(seconds)));
  setitimer(ITIMER_REAL, &timer, nullptr);
}

int interrupted_by() {
  return caught;
}

StopOnInterrupt::StopOnInterrupt() {
  catch_interrupts();
  watch_ = std::jthread([this](const std::stop_token& over) {
    using namespace std::chrono_literals;
    while (!over.stop_requested() && interrupted_by() == 0) std::this_thread::sleep_for(10ms);
    if (interrupted_by() != 0) stop_.request_stop();
  });
}

}  // namespace rayfarm
