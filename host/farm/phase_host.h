#pragma once
// The host's part in a phase of whatever kind, as the loop sees it.
#include <string>

#include "host/farm/assignment.h"
#include "protocol/job_plan.h"
#include "protocol/transport.h"

namespace rayfarm {

class PhaseHost {
 public:
  virtual ~PhaseHost() = default;
  virtual const Phase& phase() const = 0;
  /// What the assignment must know of it.
  virtual PhaseWork work() = 0;
  /// Sends an item to a node.
  virtual void assign(const AssignItem& assign) = 0;
  /// For people: "subpolygon 3 of frame 1".
  virtual std::string name_of(ItemIndex item) const = 0;
  virtual void complete(StepIndex step, double now) = 0;
  virtual void fail(const StepFailed& failed, double now) = 0;
  virtual void forget(NodeId node) = 0;  ///< it is lost, or back
};

}  // namespace rayfarm
