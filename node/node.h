#pragma once
// A processor of the net (thesis 4.4.4.2): it holds the whole scene, does items of work and returns what came
// of them. It reads nothing from disks, and waits only for its host.
#include <functional>
#include <span>
#include <string>

#include "common/lighting/ray_counts.h"
#include "common/lighting/render_pass.h"
#include "common/lighting/zones/zone_solver.h"
#include "protocol/job_plan.h"
#include "protocol/liveness.h"
#include "protocol/transport.h"

namespace rayfarm {

/// What tracing a subpolygon gave, and took.
struct ItemResult {
  Bytes bytes;  ///< its pixels
  RayCounts rays;
  bool sees_anything = true;  ///< an eye ray met something
  uint64_t not_finite = 0;    ///< pixels that are infinite or not a number
  Bytes running;              ///< what the next pass goes on from; empty after the last
};

/// Traces pictures.
class PictureWorker {
 public:
  virtual ~PictureWorker() = default;
  /// Before pictures that read zones: what a ZoneSolver found. The bytes stay valid until the next.
  virtual void set_zones(std::span<const std::byte> solution) = 0;
  /// `pulse` must be called often; what it throws must pass through.
  virtual ItemResult work(FrameNumber frame, const DisplayPolygon& polygon, const RenderPass& pass,
                          const std::function<void()>& pulse) = 0;
};

/// How a node comes by the scene's block once load code has come; the bytes stay valid while the node runs.
using LoadScene = std::function<std::span<const std::byte>(const ProcessSign& host)>;
/// Who does the work of a job. What they are given outlives them.
struct Workers {
  std::function<std::unique_ptr<PictureWorker>(const JobPlan& plan, std::span<const std::byte> scene)>
      make_pictures;
  /// Of a pose; called before the first stage of it that the node works at. A node that was away has missed
  /// stages.
  std::function<std::unique_ptr<ZoneTracer>(const JobPlan& plan, std::span<const std::byte> scene,
                                            FrameNumber frame)>
      make_zones;
};

enum class NodeEnding {
  finished,
  finished_with_losses,  ///< other nodes were lost
  failed                 ///< the host is gone or belongs to another build: a message went to stderr
};

/// Runs node `self` until the host says that the job is over.
NodeEnding run_node(Transport& transport, NodeId self, const LoadScene& load_scene, const Workers& workers);

/// Those of this program. Stands alone in its file, so that a test may be linked with others.
Workers make_workers();

/// The worker that traces pictures with the scene's renderer.
std::unique_ptr<PictureWorker> make_scene_worker(const JobPlan& plan, std::span<const std::byte> scene);

}  // namespace rayfarm
