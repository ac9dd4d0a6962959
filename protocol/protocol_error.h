#pragma once
#include <stdexcept>

namespace rayfarm {

/// Bytes from the wire that no Rayfarm of this build would send.
class ProtocolError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// MPI reported an error; the message is the library's own.
class MpiError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace rayfarm
