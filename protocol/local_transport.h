#pragma once
// Host and nodes as threads of one process: what a job of one rank runs on, and most tests.
#include <memory>
#include <vector>

#include "protocol/transport.h"

namespace rayfarm {

/// [0] is the host's end, [i] node i's. Each end is used by one thread; the ends may be destroyed in any
/// order.
std::vector<std::unique_ptr<Transport>> make_local_transports(int nodes);

}  // namespace rayfarm
