#pragma once
// What a job did: filled while it runs, read by the report and the statistics file.
#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "common/lighting/ray_counts.h"
#include "protocol/index.h"

namespace rayfarm {

struct NodeResult {
  NodeId id;
  std::string machine;
  uint32_t pid = 0;
  uint64_t subpolygons = 0;  ///< returned, duplicates too
  uint64_t rays = 0;
  double busy_s = 0;
  uint64_t zone_items = 0;  ///< returned, duplicates too
  double zone_busy_s = 0;
  bool is_lost = false;
  bool had_work = false;  ///< when it was lost
  std::string problem;    ///< for which it was expelled
};

/// What a subpolygon took, and its pixels on the net.
struct SubpolygonCost {
  double busy_s = 0;
  uint64_t bytes = 0;
};

struct FrameResult {
  FrameNumber frame;
  std::string file;
  std::string sha256;
  std::string problem;  ///< empty: written
  bool is_written = false;
  bool is_resumed = false;  ///< some of it was in a journal
  RayCounts rays;
  bool sees_anything = false;         ///< an eye ray met something
  bool is_black = false;              ///< all pixels are 0
  uint64_t not_finite = 0;            ///< pixels that are infinite or not a number
  std::vector<NodeId> traced_by;      ///< by subpolygon, if it is kept
  std::vector<SubpolygonCost> costs;  ///< by subpolygon, if they are kept
};

/// A frame whose file was not written when the job ended, and what there is of it.
struct UnfinishedFrame {
  FrameNumber frame;
  double share = 0;     ///< of its pixels that there are
  std::string journal;  ///< that holds all of them; empty: none does
  std::string preview;  ///< a picture of what there is; empty: there is none
};

/// What was done for zones before pictures.
struct ZonesResult {
  uint64_t stages = 0;
  int rounds = 0;
  RayCounts rays;
  double seconds = 0;             ///< from the beginning of stages to the light that they gave
  uint64_t data_bytes = 0;        ///< of stages and solutions, broadcast
  uint64_t assignment_bytes = 0;  ///< to nodes
  uint64_t result_bytes = 0;      ///< from nodes, those dropped too
  uint64_t results = 0;           ///< kept
  uint64_t retried = 0;           ///< items that failed at a node, and went to another
  uint64_t read = 0;              ///< solutions that were there in files
};

struct JobTimes {
  double load_s = 0, build_s = 0, broadcast_s = 0, trace_s = 0, write_s = 0, total_s = 0;
  double finish_s = 0;  ///< from the last result to the last file
  double trace_began_unix_s = 0;
  double host_cpu_s = 0;  ///< processor time of the host's process while the net traced
};

struct JobResult {
  std::vector<NodeResult> nodes;
  std::vector<FrameResult> frames;
  std::vector<UnfinishedFrame> unfinished;  ///< of frames that were begun
  uint64_t pixels_received = 0;             ///< in results, duplicates too
  uint64_t pixels_kept = 0;
  uint64_t pixels_resumed = 0;  ///< of those kept: from journals of an earlier run
  uint64_t duplicates = 0;      ///< results dropped
  RayCounts rays;               ///< of pictures, traced by this job
  ZonesResult zones;
  std::string problem;       ///< for which the job could not go on; empty: there was none
  uint64_t scene_bytes = 0;  ///< of the block that load data carries
  JobTimes times;
  bool was_interrupted = false;
  bool lost_all_nodes = false;

  NodeResult& node(NodeId id) { return nodes[id.place() - 1]; }
  const NodeResult& node(NodeId id) const { return nodes[id.place() - 1]; }
  /// What a node did not trace of the time in which the farm did.
  double idle_s(const NodeResult& node) const { return std::max(0.0, times.trace_s - node.busy_s); }
  /// The nodes that are lost at the end, in order.
  std::vector<NodeId> lost_nodes() const {
    std::vector<NodeId> lost;
    for (const NodeResult& n : nodes)
      if (n.is_lost) lost.push_back(n.id);
    return lost;
  }
  /// Why the first of the expelled nodes is; empty if none is.
  std::string first_problem() const {
    for (const NodeResult& n : nodes)
      if (!n.problem.empty()) return "node " + std::to_string(n.id.value()) + ": " + n.problem;
    return {};
  }
  size_t frames_failed() const {
    size_t n = 0;
    for (const FrameResult& f : frames) n += f.problem.empty() ? 0u : 1u;
    return n;
  }
};

}  // namespace rayfarm
