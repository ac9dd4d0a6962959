#include "protocol/mpi_transport.h"

#include "protocol/loading_steps.h"

namespace rayfarm {
namespace {

/// So many messages are taken up at a time: others that use MPI get their turn.
constexpr int kMostAtOnce = 256;

/// The tag of an empty command: how long the load code is that is broadcast next.
constexpr int kCodeComes = static_cast<int>(Channel::control) + 1;
constexpr const char* kLoadCode = "load code";

int rank_in(MPI_Comm comm) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank;
}

int nodes_in(MPI_Comm comm) {
  int size = 1;
  MPI_Comm_size(comm, &size);
  return size - 1;
}

TransferState ask(MPI_Request& request) {
  int done = 0;
  if (MPI_Test(&request, &done, MPI_STATUS_IGNORE) != MPI_SUCCESS) return TransferState::failed;
  return done ? TransferState::done : TransferState::on_its_way;
}

}  // namespace

MpiTransport::MpiTransport(MPI_Comm comm, std::mutex& in_mpi, Watchdog& watchdog)
    : Transport(nodes_in(comm), NodeId(rank_in(comm))),
      comm_(comm),
      in_mpi_(in_mpi),
      watchdog_(watchdog),
      departures_(peers()),
      arrivals_(peers()) {}

size_t MpiTransport::unsent_bytes(NodeId to) {
  const std::lock_guard lock(in_mpi_);
  departures_.settle(to, ask);
  return departures_.unsent_bytes(to);
}

void MpiTransport::do_send(NodeId to, Channel channel, Parcel parcel) {
  const std::lock_guard lock(in_mpi_);
  send_tagged(to, static_cast<int>(channel), std::move(parcel));
}

void MpiTransport::send_tagged(NodeId to, int tag, Parcel parcel) {
  departures_.settle_some(ask);
  MPI_Request request = MPI_REQUEST_NULL;
  const std::span<const std::byte> bytes = parcel.bytes();
  check_mpi(MPI_Isend(bytes.data(), to_mpi_count(bytes.size()), MPI_BYTE, to.value(), tag, comm_, &request),
            "sending");
  // Short messages have left by now.
  if (ask(request) == TransferState::on_its_way) departures_.add(to, std::move(parcel), request);
}

/// Nodes wait for messages, not for a broadcast: while the host reads and builds the scene they hear what
/// else it says, and sleep. A few bytes to each tell it when to take part.
void MpiTransport::do_load_code(Bytes message, std::function<std::string()> names_the_gone) {
  const std::lock_guard lock(in_mpi_);
  ByteWriter length;
  length.u32(static_cast<uint32_t>(to_mpi_count(message.size())));
  const auto told = std::make_shared<const Bytes>(length.take());
  for (NodeId node(1); node.value() <= node_count(); ++node) send_tagged(node, kCodeComes, told);
  LoadingSteps steps(watchdog_, true, std::move(names_the_gone));
  steps.run(kLoadCode, [&] {
    return MPI_Bcast(message.data(), to_mpi_count(message.size()), MPI_BYTE, kHost.value(), comm_);
  });
}

/// Takes part in the broadcast that `announced` announces.
Message MpiTransport::receive_code(MPI_Message& announced) {
  Bytes length(sizeof(uint32_t));
  check_mpi(MPI_Mrecv(length.data(), to_mpi_count(length.size()), MPI_BYTE, &announced, MPI_STATUS_IGNORE),
            "receiving");
  Message code{kHost, Channel::command, Bytes(ByteReader(length).u32())};
  LoadingSteps steps(watchdog_, false, {});
  steps.run(kLoadCode, [&] {
    return MPI_Bcast(code.bytes.data(), to_mpi_count(code.bytes.size()), MPI_BYTE, kHost.value(), comm_);
  });
  return code;
}

std::optional<Message> MpiTransport::do_try_receive() {
  const std::lock_guard lock(in_mpi_);
  // A look that finds nothing gives the processor away where processes share it: no second one in a row.
  if (!arrivals_.is_any_ready() && std::exchange(has_taken_all_, false)) return std::nullopt;
  if (!arrivals_.is_any_ready() || taken_ == kMostAtOnce) take_up_arrivals();
  ++taken_;
  std::optional<Message> message = arrivals_.take(ask);
  has_taken_all_ &= message.has_value();
  return message;
}

void MpiTransport::take_up_arrivals() {
  taken_ = 0;
  departures_.settle_some(ask);
  for (int i = 0; i < kMostAtOnce; ++i) {
    int found = 0;
    MPI_Message handle;
    MPI_Status status;
    check_mpi(MPI_Improbe(MPI_ANY_SOURCE, MPI_ANY_TAG, comm_, &found, &handle, &status),
              "looking for messages");
    has_taken_all_ = !found;
    if (!found) break;
    MPI_Request request = MPI_REQUEST_NULL;
    if (status.MPI_TAG == kCodeComes) {
      arrivals_.add(receive_code(handle), request, ask);
      continue;
    }
    int size = 0;
    MPI_Get_count(&status, MPI_BYTE, &size);
    Message message{NodeId(status.MPI_SOURCE), static_cast<Channel>(status.MPI_TAG),
                    Bytes(static_cast<size_t>(size))};
    check_mpi(MPI_Imrecv(message.bytes.data(), size, MPI_BYTE, &handle, &request), "receiving");
    arrivals_.add(std::move(message), request, ask);
  }
  arrivals_.look(ask);
}

}  // namespace rayfarm
