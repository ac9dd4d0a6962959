#pragma once
// The end of a job: who is still there, what hangs is ended, and the nodes hear that all is done.
#include <span>

#include "host/farm/job_result.h"
#include "protocol/liveness.h"
#include "protocol/transport.h"

namespace rayfarm {

/// Asks all nodes, and marks those as lost whose process is gone or that do not answer within a few
/// heartbeats: one that was killed or hung so late that its work was done by others before its silence was
/// long enough. The end of MPI would wait for it.
void mark_silent_nodes(Transport& transport, std::span<const ProcessSign> signs, JobResult& result);

/// Hung nodes keep mpirun from returning. Those on this machine are ended here, those on others by a node
/// beside them. True if any is left where nobody can end it.
bool end_hung_nodes(Transport& transport, const JobResult& result);

/// Tells all nodes that the job is over, and whether some are lost.
void dismiss_nodes(Transport& transport, bool has_losses);

}  // namespace rayfarm
