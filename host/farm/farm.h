#pragma once
// What the host needs of the net it works on: MPI's or this process's own.
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "protocol/transport.h"

namespace rayfarm {

struct Farm {
  Transport& transport;
  int ranks = 1;
  /// Gives every node the scene's block; the bytes may go when it returns unless the farm is local, and
  /// those before `sent` when that is called, which it is now and then. Ends the process if `names_the_gone`
  /// names a node.
  std::function<void(std::span<const std::byte> block, const std::function<void(size_t sent)>& is_sent,
                     const std::function<void(const std::string&)>& warn,
                     const std::function<std::string()>& names_the_gone)>
      load_data;
  /// Waits until no node needs the block any more. Only of a local farm; it is called when the job is over.
  std::function<void()> wait_for_nodes = [] {};
};

/// How a command ended.
struct Ending {
  int exit_code = 0;
  bool has_losses = false;      ///< nodes were lost
  bool has_hung_nodes = false;  ///< and some of them may hang where nobody can end them
};

}  // namespace rayfarm
