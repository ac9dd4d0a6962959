#pragma once
// Messages by MPI: point to point, but for load code, which is broadcast. Part of MpiSession.
#include <mpi.h>

#include <mutex>

#include "protocol/transfers.h"
#include "protocol/watchdog.h"

namespace rayfarm {

class MpiTransport : public Transport {
 public:
  /// `in_mpi` is held in every call of MPI.
  MpiTransport(MPI_Comm comm, std::mutex& in_mpi, Watchdog& watchdog);
  bool is_one_process() const override { return false; }
  size_t unsent_bytes(NodeId to) override;

 protected:
  void do_send(NodeId to, Channel channel, Parcel parcel) override;
  void do_load_code(Bytes message, std::function<std::string()> names_the_gone) override;
  std::optional<Message> do_try_receive() override;

 private:
  void send_tagged(NodeId to, int tag, Parcel parcel);
  Message receive_code(MPI_Message& announced);
  void take_up_arrivals();

  MPI_Comm comm_;
  std::mutex& in_mpi_;
  Watchdog& watchdog_;
  Departures<MPI_Request> departures_;
  Arrivals<MPI_Request> arrivals_;
  int taken_ = 0;  ///< since arrivals were last taken up
  bool has_taken_all_ =
      false;  ///< the last look for messages found no more, and what it found was not asked for
};

}  // namespace rayfarm
