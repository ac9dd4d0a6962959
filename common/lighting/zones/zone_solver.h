#pragma once
// Light that zones hold, found before pictures are made (the thesis's 2.2.5; Shirley, Sung and Brown 1991,
// section 3). The work goes in stages. A stage's data goes to all nodes, its items can be done by any of them
// in any order, and what they answer is added up as integers, so that neither the cut nor the order can show.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/lighting/ray_counts.h"
#include "common/scene/render_settings.h"
#include "common/scene/scene.h"

namespace rayfarm {

/// What nodes are to do next.
struct ZoneStage {
  std::string name;             ///< for people: "light from sources", "round 3"
  std::vector<std::byte> data;  ///< every node holds it before it does an item
  uint64_t units = 0;           ///< zones or rays
  uint64_t units_per_item = 1;  ///< the last item has what is left

  uint64_t items() const { return (units + units_per_item - 1) / units_per_item; }
};

struct ZoneProgress {
  int rounds = 0;     ///< begun
  double unsent = 1;  ///< the part of all primary power that is still to be sent
  uint64_t rays = 0;  ///< traced by all nodes
};

/// The host's part: it holds the sums. One for each pose of a job.
class ZoneSolver {
 public:
  virtual ~ZoneSolver() = default;
  /// Call it when all items of the stage before have been added. None: the solution is there.
  virtual std::optional<ZoneStage> next_stage() = 0;
  /// What an item of this stage gave, each once. Throws std::runtime_error, with nothing changed, if the
  /// bytes are not such a result.
  virtual void add(uint64_t item, std::span<const std::byte> result) = 0;
  virtual ZoneProgress progress() const = 0;
  /// What nodes need for pictures, and what a file of zones holds.
  virtual std::vector<std::byte> solution() const = 0;
};

/// Of the lighting model, which must be one with zones, at `frame`. What `scene` looks at must outlive it.
/// Throws std::runtime_error if zones need more memory than is allowed, and std::domain_error if the frame
/// has no pose.
std::unique_ptr<ZoneSolver> make_zone_solver(const Scene& scene, const RenderSettings& settings, int frame);

struct ZoneItemResult {
  std::vector<std::byte> bytes;
  RayCounts rays;
};

/// A node's part.
class ZoneTracer {
 public:
  virtual ~ZoneTracer() = default;
  /// A new stage. Throws std::runtime_error if the data are damaged.
  virtual void begin(std::span<const std::byte> stage_data) = 0;
  /// Units [first, first + count) of the stage. `pulse` is called often; what it throws passes through.
  virtual ZoneItemResult work(uint64_t first, uint64_t count, const std::function<void()>& pulse) = 0;
};

std::unique_ptr<ZoneTracer> make_zone_tracer(const Scene& scene, const RenderSettings& settings, int frame);

// Each stands in its model's files.
std::unique_ptr<ZoneSolver> make_zonal_solver(const Scene& scene, const RenderSettings& settings, int frame);
std::unique_ptr<ZoneTracer> make_zonal_tracer(const Scene& scene, const RenderSettings& settings, int frame);
std::unique_ptr<ZoneSolver> make_matrix_solver(const Scene& scene, const RenderSettings& settings, int frame);
std::unique_ptr<ZoneTracer> make_matrix_tracer(const Scene& scene, const RenderSettings& settings, int frame);

}  // namespace rayfarm
