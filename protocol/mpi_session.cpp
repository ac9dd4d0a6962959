#include "protocol/mpi_session.h"

#include <fmt/core.h>
#include <mpi.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <list>
#include <mutex>
#include <vector>

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

void check(int code, const char* what) {
  if (code == MPI_SUCCESS) return;
  char text[MPI_MAX_ERROR_STRING];
  int length = 0;
  MPI_Error_string(code, text, &length);
  throw MpiError(fmt::format("{}: {}", what, std::string(text, static_cast<size_t>(length))));
}

int to_int(size_t n) {
  if (n > static_cast<size_t>(std::numeric_limits<int>::max()))
    throw MpiError("a message is longer than 2 GiB");
  return static_cast<int>(n);
}

class MpiTransport : public Transport {
 public:
  /// `in_mpi` is held in every call of MPI.
  MpiTransport(MPI_Comm comm, std::mutex& in_mpi) : comm_(comm), in_mpi_(in_mpi) {
    int rank = 0, size = 1;
    MPI_Comm_rank(comm, &rank);
    MPI_Comm_size(comm, &size);
    nodes_ = size - 1;
    receives_.resize(static_cast<size_t>(size));
    unsent_.resize(static_cast<size_t>(size));
    if (rank == kHostRank) own_meter(nodes_);
  }
  int node_count() const override { return nodes_; }
  bool is_one_process() const override { return false; }
  size_t unsent_bytes(NodeId to) override {
    const std::lock_guard lock(in_mpi_);
    drop_finished_sends();
    return unsent_[to.place()];
  }

 protected:
  void do_send(NodeId to, Channel channel, Bytes bytes) override {
    const std::lock_guard lock(in_mpi_);
    drop_finished_sends();
    sends_.push_back({{MPI_REQUEST_NULL, std::move(bytes)}, to});
    Pending& s = sends_.back().pending;
    unsent_[to.place()] += s.bytes.size();
    check(MPI_Isend(s.bytes.data(), to_int(s.bytes.size()), MPI_BYTE, to.value(), static_cast<int>(channel),
                    comm_, &s.request),
          "sending");
  }

  std::optional<Message> do_try_receive() override {
    const std::lock_guard lock(in_mpi_);
    drop_finished_sends();
    while (true) {  // take up all that has arrived
      int found = 0;
      MPI_Message handle;
      MPI_Status status;
      check(MPI_Improbe(MPI_ANY_SOURCE, MPI_ANY_TAG, comm_, &found, &handle, &status),
            "looking for messages");
      if (!found) break;
      int size = 0;
      MPI_Get_count(&status, MPI_BYTE, &size);
      auto& queue = receives_[static_cast<size_t>(status.MPI_SOURCE)];
      queue.push_back(
          {{MPI_REQUEST_NULL, Bytes(static_cast<size_t>(size))}, static_cast<Channel>(status.MPI_TAG)});
      Receive& receive = queue.back();
      check(MPI_Imrecv(receive.pending.bytes.data(), size, MPI_BYTE, &handle, &receive.pending.request),
            "receiving");
    }
    // A long message whose sender died never completes: only that sender's queue waits behind it.
    const size_t ends = receives_.size();
    for (size_t i = 0; i < ends; ++i) {
      const size_t source = (next_ + i) % ends;
      auto& queue = receives_[source];
      if (queue.empty()) continue;
      int done = 0;
      const int code = MPI_Test(&queue.front().pending.request, &done, MPI_STATUS_IGNORE);
      if (code != MPI_SUCCESS) {  // the sender was lost in the middle: what it sent is lost with it
        queue.pop_front();
        continue;
      }
      if (!done) continue;
      Message message{NodeId(static_cast<int>(source)), queue.front().channel,
                      std::move(queue.front().pending.bytes)};
      queue.pop_front();
      next_ = source + 1;
      return message;
    }
    return std::nullopt;
  }

 private:
  struct Pending {
    MPI_Request request;
    Bytes bytes;
  };
  struct Send {
    Pending pending;
    NodeId to;
  };
  struct Receive {
    Pending pending;
    Channel channel;
  };

  void drop_finished_sends() {
    for (auto i = sends_.begin(); i != sends_.end();) {
      int done = 0;
      const int code = MPI_Test(&i->pending.request, &done, MPI_STATUS_IGNORE);
      const bool is_over = done || code != MPI_SUCCESS;
      if (is_over) unsent_[i->to.place()] -= i->pending.bytes.size();
      i = is_over ? sends_.erase(i) : std::next(i);
    }
  }

  MPI_Comm comm_;
  std::mutex& in_mpi_;
  int nodes_ = 0;
  size_t next_ = 0;
  std::list<Send> sends_;
  std::vector<size_t> unsent_;  ///< bytes of sends_, by whom they go to
  std::vector<std::deque<Receive>> receives_;
};

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

  void arm(const char* what) {
    watchdog.arm(
        rank == kHostRank ? liveness::kLoadingStep_s : liveness::kLoadingStepOfNodes_s,
        fmt::format("a process was lost while loading ({}); the job ends. Start it again, without the "
                    "machine that failed",
                    what));
  }

  /// Runs one collective step under the watchdog.
  template <typename Step>
  void collective(const char* what, Step step) {
    arm(what);
    check(step(), what);
    watchdog.disarm();
  }

  /// Waits until every process of the machine is here. However long the machine's leader receives, it is
  /// alive as long as `progress` (may be null) grows.
  void wait_for_machine(MPI_Comm machine, uint64_t* progress) {
    MPI_Request request = MPI_REQUEST_NULL;
    check(MPI_Ibarrier(machine, &request), "the end of loading");
    constexpr const char* kWhat = "the machine's copy";
    arm(kWhat);
    uint64_t seen = 0;
    for (Backoff backoff;; backoff.wait()) {
      int done = 0;
      check(MPI_Test(&request, &done, MPI_STATUS_IGNORE), "the end of loading");
      if (done) break;
      const uint64_t now = progress ? std::atomic_ref(*progress).load() : seen;
      if (now != seen) arm(kWhat);
      seen = now;
    }
    watchdog.disarm();
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
  return std::make_unique<MpiTransport>(state_->comm, state_->in_mpi);
}

std::unique_ptr<SharedBlock> MpiSession::load_data(std::span<const std::byte> block,
                                                   const std::function<void(size_t sent)>& is_sent,
                                                   TrafficMeter* meter,
                                                   const std::function<void(const std::string&)>& warn,
                                                   std::function<std::string()> names_the_gone) {
  State& s = *state_;
  const std::lock_guard lock(s.in_mpi);  // no heartbeats meanwhile: nobody listens for them
  s.watchdog.set_witness(std::move(names_the_gone));
  struct Calm {  // however this ends, the watchdog does not end the job for it
    Watchdog& watchdog;
    ~Calm() {
      watchdog.disarm();
      watchdog.set_witness({});
    }
  } const calm{s.watchdog};
  uint64_t size = block.size();
  s.collective("the scene's size", [&] { return MPI_Bcast(&size, 1, MPI_UINT64_T, kHostRank, s.comm); });

  // One leader a machine takes part in the broadcast over the net; the host leads its own.
  MPI_Comm machine = MPI_COMM_NULL, leaders = MPI_COMM_NULL;
  s.collective("grouping by machine", [&] {
    return MPI_Comm_split_type(s.comm, MPI_COMM_TYPE_SHARED, s.rank, MPI_INFO_NULL, &machine);
  });
  MPI_Comm_set_errhandler(machine, MPI_ERRORS_RETURN);
  int machine_rank = 0, machine_size = 1;
  MPI_Comm_rank(machine, &machine_rank);
  MPI_Comm_size(machine, &machine_size);

  // Only the machine's leader knows whether its memory is there.
  const auto agree = [&](bool leader_says) {
    int is_shared = leader_says ? 1 : 0;
    s.collective("choosing the memory", [&] { return MPI_Bcast(&is_shared, 1, MPI_INT, 0, machine); });
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
    s.collective("making shared memory", [&] {
      return MPI_Win_allocate_shared(machine_rank == 0 ? static_cast<MPI_Aint>(window_bytes) : 0, 1,
                                     MPI_INFO_NULL, machine, &own, &window);
    });
    is_shared = agree(machine_rank != 0 || claim_shared_memory(own, window_bytes));
    if (is_shared) {
      MPI_Aint window_size = 0;
      int unit = 1;
      check(MPI_Win_shared_query(window, 0, &window_size, &unit, &target), "finding shared memory");
      // Processes map the window where they like, but always by whole pages, so the padding is the same for
      // all.
      target += (64 - reinterpret_cast<uintptr_t>(target) % 64) % 64;
      // Behind the block stands how much of it has come, for those who only wait.
      progress = reinterpret_cast<uint64_t*>(target + size);
      if (machine_rank == 0) std::atomic_ref(*progress).store(0);
      result = std::make_unique<WindowBlock>(target, size);
    } else {
      s.collective("giving shared memory back", [&] { return MPI_Win_free(&window); });
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
  s.collective("choosing the receivers",
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
      s.collective("broadcasting the scene", [&] {
        return MPI_Bcast(message.data(), to_int(message.size()), MPI_BYTE, kHostRank, leaders);
      });
      const LoadData data = decode_load_data(message);
      if (data.address > size || data.payload.size() > size - data.address)
        throw ProtocolError("load data lies outside of the scene");
      if (target) std::memcpy(target + data.address, data.payload.data(), data.payload.size());
      if (progress) std::atomic_ref(*progress).store(data.address + data.payload.size());
      if (s.rank == kHostRank) is_sent(offset + length);
    }
  }
  s.wait_for_machine(machine, progress);
  s.collective("the end of loading", [&] { return MPI_Barrier(s.comm); });
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
