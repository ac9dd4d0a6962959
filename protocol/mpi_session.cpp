#include "protocol/mpi_session.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <vector>

#include "protocol/loading_steps.h"
#include "protocol/mpi_transport.h"
#include "protocol/shared_memory.h"
#include "protocol/time_limits.h"

namespace rayfarm {
namespace {

constexpr int kHostRank = kHost.value();

/// How long MPI may take to start: longer where many processes share few cores.
double start_limit_s() {
  const char* size = std::getenv("OMPI_COMM_WORLD_SIZE");
  const int beyond = (size ? std::atoi(size) : 0) - liveness::kStartTogether;
  return liveness::kLoadingStep_s + liveness::kStartOfProcess_s * std::max(0, beyond);
}

class WindowBlock : public SharedBlock {
 public:
  WindowBlock(std::byte* data, size_t size) : data_(data), size_(size) {}
  std::span<const std::byte> bytes() const override { return {data_, size_}; }

 private:
  std::byte* data_;  // the window itself is never freed: that would wait for the dead
  size_t size_;
};

class PrivateBlock : public SharedBlock {
 public:
  explicit PrivateBlock(size_t size) : size_(size), data_(allocate_pages(size), &std::free) {}
  std::span<const std::byte> bytes() const override { return {data_.get(), size_}; }
  std::byte* data() { return data_.get(); }

 private:
  size_t size_;
  std::unique_ptr<std::byte, decltype(&std::free)> data_;
};

}  // namespace

struct MpiSession::State {
  Watchdog watchdog;
  MPI_Comm comm = MPI_COMM_NULL;
  std::mutex in_mpi;  ///< one thread at a time calls MPI
  int rank = 0, size = 1;

  /// Waits until every process of the machine is here. However long the machine's leader receives, it is
  /// alive as long as `progress` (may be null) grows.
  static void wait_for_machine(MPI_Comm machine, uint64_t* progress, LoadingSteps& steps) {
    MPI_Request request = MPI_REQUEST_NULL;
    check_mpi(MPI_Ibarrier(machine, &request), "the end of loading");
    constexpr const char* kWhat = "the machine's copy";
    steps.begin(kWhat);
    uint64_t seen = 0;
    for (Backoff backoff;; backoff.wait()) {
      int done = 0;
      check_mpi(MPI_Test(&request, &done, MPI_STATUS_IGNORE), "the end of loading");
      if (done) break;
      const uint64_t now = progress ? std::atomic_ref(*progress).load() : seen;
      if (now != seen) steps.begin(kWhat);
      seen = now;
    }
    steps.end();
  }
};

bool MpiSession::is_launched() {
  return std::getenv("OMPI_COMM_WORLD_SIZE") || std::getenv("PMIX_RANK") || std::getenv("PMI_RANK");
}

MpiSession::MpiSession(int* argc, char*** argv) : state_(std::make_unique<State>()) {
  state_->watchdog.arm(start_limit_s(),
                       "MPI did not start: a process was lost, or a machine can't be reached");
  // The heart sends beside the thread that does all else.
  int provided = MPI_THREAD_SINGLE;
  MPI_Init_thread(argc, argv, MPI_THREAD_SERIALIZED, &provided);
  if (provided < MPI_THREAD_SERIALIZED) {
    std::fprintf(stderr,
                 "rayfarm: this MPI can't be called by more than one thread; use another build of it\n");
    end_job(1);
  }
  state_->watchdog.arm(start_limit_s(), "a process was lost while MPI started");
  // A communicator of our own: without this the return codes below would never be seen.
  MPI_Comm_dup(MPI_COMM_WORLD, &state_->comm);
  MPI_Comm_set_errhandler(state_->comm, MPI_ERRORS_RETURN);
  MPI_Comm_rank(state_->comm, &state_->rank);
  MPI_Comm_size(state_->comm, &state_->size);
  state_->watchdog.disarm();
}

MpiSession::~MpiSession() = default;

int MpiSession::rank() const {
  return state_->rank;
}
int MpiSession::size() const {
  return state_->size;
}

std::unique_ptr<Transport> MpiSession::make_transport() {
  return std::make_unique<MpiTransport>(state_->comm, state_->in_mpi, state_->watchdog);
}

std::unique_ptr<SharedBlock> MpiSession::load_data(std::span<const std::byte> block,
                                                   const std::function<void(size_t sent)>& is_sent,
                                                   TrafficMeter* meter,
                                                   const std::function<void(const std::string&)>& warn,
                                                   std::function<std::string()> names_the_gone) {
  State& s = *state_;
  const std::lock_guard lock(s.in_mpi);  // no heartbeats meanwhile: nobody listens for them
  LoadingSteps steps(s.watchdog, s.rank == kHostRank, std::move(names_the_gone));
  uint64_t size = block.size();
  steps.run("the scene's size", [&] { return MPI_Bcast(&size, 1, MPI_UINT64_T, kHostRank, s.comm); });

  // One leader a machine takes part in the broadcast over the net; the host leads its own.
  MPI_Comm machine = MPI_COMM_NULL, leaders = MPI_COMM_NULL;
  steps.run("grouping by machine", [&] {
    return MPI_Comm_split_type(s.comm, MPI_COMM_TYPE_SHARED, s.rank, MPI_INFO_NULL, &machine);
  });
  MPI_Comm_set_errhandler(machine, MPI_ERRORS_RETURN);
  int machine_rank = 0, machine_size = 1;
  MPI_Comm_rank(machine, &machine_rank);
  MPI_Comm_size(machine, &machine_size);

  // Only the machine's leader knows whether its memory is there.
  const auto agree = [&](bool leader_says) {
    int is_shared = leader_says ? 1 : 0;
    steps.run("choosing the memory", [&] { return MPI_Bcast(&is_shared, 1, MPI_INT, 0, machine); });
    return is_shared != 0;
  };
  std::unique_ptr<SharedBlock> result;
  std::byte* target = nullptr;
  uint64_t* progress = nullptr;
  bool lacks_memory = false;
  bool is_shared = agree(shared_memory_seems_to_hold(size));
  if (is_shared) {
    MPI_Win window = MPI_WIN_NULL;
    std::byte* own = nullptr;
    const size_t window_bytes = size + 2 * kDataWordBytes;
    steps.run("making shared memory", [&] {
      return MPI_Win_allocate_shared(machine_rank == 0 ? static_cast<MPI_Aint>(window_bytes) : 0, 1,
                                     MPI_INFO_NULL, machine, &own, &window);
    });
    is_shared = agree(machine_rank != 0 || claim_shared_memory(own, window_bytes));
    if (is_shared) {
      MPI_Aint window_size = 0;
      int unit = 1;
      check_mpi(MPI_Win_shared_query(window, 0, &window_size, &unit, &target), "finding shared memory");
      // Processes map the window where they like, but always by whole pages, so the padding is the same for
      // all.
      target += (64 - reinterpret_cast<uintptr_t>(target) % 64) % 64;
      // Behind the block stands how much of it has come, for those who only wait.
      progress = reinterpret_cast<uint64_t*>(target + size);
      if (machine_rank == 0) std::atomic_ref(*progress).store(0);
      result = std::make_unique<WindowBlock>(target, size);
    } else {
      steps.run("giving shared memory back", [&] { return MPI_Win_free(&window); });
    }
  }
  if (!is_shared) {
    if (machine_rank == 0)
      warn(fmt::format(
          "/dev/shm has no room for the scene's {} MiB: the {} processes on this machine hold a copy each",
          size >> 20, machine_size));
    try {
      if (s.rank != kHostRank) {  // which has the block that it sends
        auto own = std::make_unique<PrivateBlock>(size);
        target = own->data();
        result = std::move(own);
      }
    } catch (const std::bad_alloc&) {
      lacks_memory = true;  // told when all have loaded: nobody waits for this node meanwhile
    }
  }

  // With a shared copy only leaders receive; without, every process does.
  const bool receives = is_shared ? machine_rank == 0 : !lacks_memory;
  steps.run("choosing the receivers",
            [&] { return MPI_Comm_split(s.comm, receives ? 0 : MPI_UNDEFINED, s.rank, &leaders); });
  if (receives) {
    MPI_Comm_set_errhandler(leaders, MPI_ERRORS_RETURN);
    Bytes message;
    for (uint64_t offset = 0; offset < size; offset += kChunkBytes) {
      const size_t length = std::min<uint64_t>(kChunkBytes, size - offset);
      if (s.rank == kHostRank) {
        encode_load_data({offset, block.subspan(offset, length)}, message);
        if (meter) meter->count_command(kHost, Direction::to_node, Command::load_data, {1, message.size()});
      } else {
        message.resize(kLoadHeaderBytes + length);
      }
      steps.run("broadcasting the scene", [&] {
        return MPI_Bcast(message.data(), to_mpi_count(message.size()), MPI_BYTE, kHostRank, leaders);
      });
      const LoadData data = decode_load_data(message);
      if (data.address > size || data.payload.size() > size - data.address)
        throw ProtocolError("load data lies outside of the scene");
      if (target) std::memcpy(target + data.address, data.payload.data(), data.payload.size());
      if (progress) std::atomic_ref(*progress).store(data.address + data.payload.size());
      if (s.rank == kHostRank) is_sent(offset + length);
    }
  }
  State::wait_for_machine(machine, progress, steps);
  steps.run("the end of loading", [&] { return MPI_Barrier(s.comm); });
  if (lacks_memory) throw std::runtime_error("there is no memory for its copy of the scene");
  return result;
}

void MpiSession::finish(int code, Parting parting) {
  std::fflush(nullptr);
  if (parting == Parting::ending_the_hung) {
    // With recovery switched on mpirun still returns 0.
    state_->watchdog.arm(liveness::kEnding_s, "the job's last processes did not end");
    MPI_Abort(state_->comm, code);
  }
  if (code != 0 || parting == Parting::without_the_lost) end_job(code);
  state_->watchdog.arm(liveness::kEnding_s, "MPI did not end by itself");
  MPI_Finalize();
  state_->watchdog.disarm();
  _exit(0);
}

}  // namespace rayfarm
