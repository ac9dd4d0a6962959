#pragma once
// Messages by MPI, point to point. Part of MpiSession.
#include <mpi.h>

#include <mutex>
#include <string>

#include "protocol/transfers.h"

namespace rayfarm {

/// Throws MpiError with the library's own words.
void check_mpi(int code, const char* what);
/// What MPI counts is an int. Throws MpiError.
int to_mpi_count(size_t n);

class MpiTransport : public Transport {
 public:
  /// `in_mpi` is held in every call of MPI.
  MpiTransport(MPI_Comm comm, std::mutex& in_mpi);
  bool is_one_process() const override { return false; }
  size_t unsent_bytes(NodeId to) override;

 protected:
  void do_send(NodeId to, Channel channel, Parcel parcel) override;
  std::optional<Message> do_try_receive() override;

 private:
  void take_up_arrivals();

  MPI_Comm comm_;
  std::mutex& in_mpi_;
  Departures<MPI_Request> departures_;
  Arrivals<MPI_Request> arrivals_;
  int taken_ = 0;  ///< since arrivals were last taken up
};

}  // namespace rayfarm
