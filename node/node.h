#pragma once
// A processor of the net (thesis 4.4.4.2): it holds the whole scene, does items of work and returns what came
// of them. It reads nothing from disks, and waits only for its host.
#include <functional>
#include <span>
#include <string>

#include "common/lighting/ray_counts.h"
#include "protocol/job_plan.h"
#include "protocol/liveness.h"
#include "protocol/transport.h"

namespace rayfarm {

/// What doing an item gave, and took.
struct ItemResult {
  Bytes bytes;  ///< of pictures: the subpolygon's pixels
  RayCounts rays;
  bool sees_anything = true;  ///< an eye ray met something
  uint64_t not_finite = 0;    ///< pixels that are infinite or not a number
};

/// Does the work of a phase.
class PhaseWorker {
 public:
  virtual ~PhaseWorker() = default;
  /// `pulse` must be called often; what it throws must pass through.
  virtual ItemResult work(ItemIndex item, const std::function<void()>& pulse) = 0;
};

/// How a node comes by the scene's block once load code has come; the bytes stay valid while the node runs.
using LoadScene = std::function<std::span<const std::byte>(const ProcessSign& host)>;
using MakeWorker = std::function<std::unique_ptr<PhaseWorker>(const JobPlan& plan, const Phase& phase,
                                                              std::span<const std::byte> scene)>;

enum class NodeEnding {
  finished,
  finished_with_losses,  ///< other nodes were lost
  failed                 ///< the host is gone or belongs to another build: a message went to stderr
};

/// Runs node `self` until the host says that the job is over.
NodeEnding run_node(Transport& transport, NodeId self, const LoadScene& load_scene,
                    const MakeWorker& make_worker);

/// The worker that traces the pictures' phase with the scene's renderer. `plan` and `phase` must outlive it.
std::unique_ptr<PhaseWorker> make_scene_worker(const JobPlan& plan, const Phase& phase,
                                               std::span<const std::byte> scene);

}  // namespace rayfarm
