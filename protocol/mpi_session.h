#pragma once
// MPI from start to end, and the only place where collectives run: while loading. Afterwards nothing may wait
// for a process that could be dead, so all else is point to point, and shared windows are left to the
// runtime.
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "protocol/transport.h"
#include "protocol/watchdog.h"

namespace rayfarm {

/// A scene block that this process can read: its own, or its machine's shared copy.
class SharedBlock {
 public:
  virtual ~SharedBlock() = default;
  virtual std::span<const std::byte> bytes() const = 0;
};

/// How a process leaves its job.
enum class Parting {
  together,          ///< all are alive: MPI is ended properly
  without_the_lost,  ///< some are gone, and MPI's own end would wait for them: the runtime cleans up
  ending_the_hung    ///< hung processes are left on machines where nobody can end them: the runtime ends all
};

class MpiSession {
 public:
  /// True if this process was started by mpirun, srun or another launcher that MPI knows.
  static bool is_launched();

  /// Starts MPI. Ends the job with a message if that takes longer than any sane start (a process was lost).
  MpiSession(int* argc, char*** argv);
  ~MpiSession();
  MpiSession(const MpiSession&) = delete;
  MpiSession& operator=(const MpiSession&) = delete;

  int rank() const;
  int size() const;
  std::unique_ptr<Transport> make_transport();

  /// Collective: gives every machine one copy of the host's block in shared memory, in chunks of load data.
  /// Where /dev/shm is too small the machine's processes hold a copy each, and `warn` is called on one of
  /// them; the host's own is then the one it sends, and null is returned. `block` is read on rank 0 only,
  /// where `is_sent` is told now and then before which of its bytes nothing is read any more. A process lost
  /// meanwhile ends the job: at once if `names_the_gone` (see Watchdog) names it, else within
  /// kLoadingStepOfNodes_s.
  std::unique_ptr<SharedBlock> load_data(std::span<const std::byte> block,
                                         const std::function<void(size_t sent)>& is_sent, TrafficMeter* meter,
                                         const std::function<void(const std::string&)>& warn,
                                         std::function<std::string()> names_the_gone);

  /// Ends the process, and MPI with it.
  [[noreturn]] void finish(int code, Parting parting);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rayfarm
