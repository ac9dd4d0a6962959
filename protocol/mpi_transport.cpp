#include "protocol/mpi_transport.h"

#include <fmt/core.h>

#include <limits>

#include "protocol/mpi_session.h"
#include "protocol/protocol_error.h"

namespace rayfarm {
namespace {

/// So many messages are taken up at a time: others that use MPI get their turn.
constexpr int kMostAtOnce = 256;

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

MpiTransport::MpiTransport(MPI_Comm comm, std::mutex& in_mpi)
    : Transport(nodes_in(comm), NodeId(rank_in(comm))),
      comm_(comm),
      in_mpi_(in_mpi),
      departures_(peers()),
      arrivals_(peers()) {}

size_t MpiTransport::unsent_bytes(NodeId to) {
  const std::lock_guard lock(in_mpi_);
  departures_.settle(to, ask);
  return departures_.unsent_bytes(to);
}

void MpiTransport::do_send(NodeId to, Channel channel, Parcel parcel) {
  const std::lock_guard lock(in_mpi_);
  departures_.settle_some(ask);
  MPI_Request request = MPI_REQUEST_NULL;
  const std::span<const std::byte> bytes = parcel.bytes();
  check_mpi(MPI_Isend(bytes.data(), to_mpi_count(bytes.size()), MPI_BYTE, to.value(),
                      static_cast<int>(channel), comm_, &request),
            "sending");
  // Short messages have left by now.
  if (ask(request) == TransferState::on_its_way) departures_.add(to, std::move(parcel), request);
}

std::optional<Message> MpiTransport::do_try_receive() {
  const std::lock_guard lock(in_mpi_);
  if (!arrivals_.is_any_ready() || taken_ == kMostAtOnce) take_up_arrivals();
  ++taken_;
  return arrivals_.take(ask);
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
    if (!found) break;
    int size = 0;
    MPI_Get_count(&status, MPI_BYTE, &size);
    Message message{NodeId(status.MPI_SOURCE), static_cast<Channel>(status.MPI_TAG),
                    Bytes(static_cast<size_t>(size))};
    MPI_Request request = MPI_REQUEST_NULL;
    check_mpi(MPI_Imrecv(message.bytes.data(), size, MPI_BYTE, &handle, &request), "receiving");
    arrivals_.add(std::move(message), request, ask);
  }
  arrivals_.look(ask);
}

}  // namespace rayfarm
