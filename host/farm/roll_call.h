#pragma once
// Who is there while the scene loads, before anything is traced.
#include <functional>
#include <string>
#include <vector>

#include "host/farm/job_result.h"
#include "protocol/liveness.h"
#include "protocol/transport.h"

namespace rayfarm {

/// Takes the nodes' reports while the scene loads. Nobody can be done without before the scene is loaded
/// everywhere, so a node that is gone ends the job; one that is merely silent may have been stopped for a
/// while.
class RollCall {
 public:
  /// Says hello to all nodes. Fills result.nodes.
  RollCall(Transport& transport, JobResult& result);

  /// One turn. Throws JobError if a node is lost or of another build, or if the user stopped the job.
  void serve();
  bool all_reported() const { return reported_ == heard_.size(); }

  /// Of the nodes that are other processes, in order; empty if they are threads of this one.
  const std::vector<ProcessSign>& signs() const { return signs_; }
  /// Names a node that is gone (see make_witness).
  std::function<std::string()> make_node_witness() const;

 private:
  void judge(size_t i);
  Transport& transport_;
  JobResult& result_;
  ListeningClock listening_;
  std::vector<double> heard_;  ///< by the listening clock; below 0: never
  size_t reported_ = 0;        ///< how many were heard
  std::vector<ProcessSign> signs_;
  double looked_s_ = 0;
};

}  // namespace rayfarm
