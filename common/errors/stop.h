#pragma once
// Loading and building can be stopped from another thread: long loops look at a std::stop_token at least
// every few hundred milliseconds.
#include <stdexcept>
#include <stop_token>

namespace rayfarm {

/// Thrown out of loaders and builders that were asked to stop.
class Stopped : public std::runtime_error {
 public:
  Stopped() : std::runtime_error("stopped") {}
};

inline void throw_if_stopped(const std::stop_token& stop) {
  if (stop.stop_requested()) throw Stopped();
}

}  // namespace rayfarm
