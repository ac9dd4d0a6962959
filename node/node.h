#pragma once
// A processor of the net (thesis 4.4.4.2): it holds the whole scene, traces subpolygons and returns their
// pixels. It reads nothing from disks, and waits only for its host.
#include <functional>
#include <span>
#include <string>

#include "common/lighting/ray_counts.h"
#include "protocol/job_plan.h"
#include "protocol/liveness.h"
#include "protocol/transport.h"

namespace rayfarm {

/// Traces subpolygons; a node has one.
class SubpolygonTracer {
 public:
  virtual ~SubpolygonTracer() = default;
  struct Traced {
    Bytes pixels;
    RayCounts rays;
    bool sees_anything = true;  ///< an eye ray met something
    uint64_t not_finite = 0;    ///< pixels that are infinite or not a number
  };
  /// `pulse` must be called often; what it throws must pass through.
  virtual Traced trace(int frame, const DisplayPolygon& polygon, const std::function<void()>& pulse) = 0;
};

/// How a node comes by the scene's block once load code has come; the bytes stay valid while the node runs.
using LoadScene = std::function<std::span<const std::byte>(const ProcessSign& host)>;
using MakeTracer =
    std::function<std::unique_ptr<SubpolygonTracer>(const JobPlan& plan, std::span<const std::byte> scene)>;

enum class NodeEnding {
  finished,
  finished_with_losses,  ///< other nodes were lost
  failed                 ///< the host is gone or belongs to another build: a message went to stderr
};

/// Runs node `self` (1 … n) until the host says that the job is over.
NodeEnding run_node(Transport& transport, int self, const LoadScene& load_scene,
                    const MakeTracer& make_tracer);

/// The tracer of the scene's renderer.
std::unique_ptr<SubpolygonTracer> make_scene_tracer(const JobPlan& plan, std::span<const std::byte> scene);

}  // namespace rayfarm
