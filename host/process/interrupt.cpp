#include "host/process/interrupt.h"

#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <chrono>

namespace rayfarm {
namespace {

std::atomic<int> caught{0};
static_assert(std::atomic<int>::is_always_lock_free);

void on_signal(int number) {
  int none = 0;
  if (!caught.compare_exchange_strong(none, number)) _exit(128 + number);
}

}  // namespace

void catch_interrupts() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) sigaction(number, &action, nullptr);
  // Who reads the text may leave: the pictures are written all the same.
  signal(SIGPIPE, SIG_IGN);
  signal(SIGXFSZ, SIG_IGN);  // a file beyond the limit (ulimit -f) is one that can't be written
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
