#include "host/process/interrupt.h"

#include <signal.h>
#include <sys/time.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>

#include "protocol/clock.h"

namespace rayfarm {
namespace {

std::atomic<int> caught{0};
std::atomic<double> caught_s{0},
    looked_s{0};  ///< when it came, and when somebody last looked whether any did
static_assert(std::atomic<double>::is_always_lock_free);
constexpr double kSameWish_s = 0.3;
/// A process that works looks far more often; one that was stopped and goes on has not looked meanwhile.
constexpr double kLongestLook_s = 0.15;
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
  const double now = now_s();
  if (caught.compare_exchange_strong(before, number)) {
    caught_s = now;
    return;
  }
  // What comes at once is the same wish again: `timeout` signals a process and its group.
  if (is_warning(number) || now - caught_s < kSameWish_s) return;
  if (is_warning(before) && caught.compare_exchange_strong(before, number)) return;
  if (may_be_impatient) _exit(128 + number);
}

/// mpirun that is told to end lets its processes go on (SIGCONT), and kills them a second later, SIGTERM
/// coming just before: so SIGCONT is the wish. It also comes to who was stopped; but then this process has
/// not looked for long.
void on_continue(int, siginfo_t* info, void*) {
  if (info->si_pid != getppid() || now_s() - looked_s > kLongestLook_s) return;
  int before = 0;
  if (caught.compare_exchange_strong(before, SIGTERM)) caught_s = now_s();
}

}  // namespace

void catch_interrupts() {
  may_be_impatient = std::getenv("OMPI_COMM_WORLD_RANK") == nullptr;
  struct sigaction action {};
  action.sa_handler = on_signal;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGALRM}) sigaction(number, &action, nullptr);
  if (!may_be_impatient) {
    action.sa_sigaction = on_continue;
    action.sa_flags = SA_RESTART | SA_SIGINFO;
    sigaction(SIGCONT, &action, nullptr);
  }
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
  looked_s = now_s();
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
