#pragma once
// The farm's side of load code: what host and nodes agree on beside the render settings, which travel as
// bytes that this room doesn't look into.
#include <string>
#include <vector>

#include "protocol/phase.h"
#include "protocol/time_limits.h"

namespace rayfarm {

enum class AssignmentPolicy : uint8_t { on_demand, interleaved };
enum class Wire : uint8_t { block, pixel };

/// The least side of subpolygons, unless another is asked for: the pixel wire's 9 bytes are the same for any.
constexpr int least_side_of(Wire wire) {
  return wire == Wire::pixel ? 1 : kLeastBlockSide_px;
}

struct JobPlan {
  std::string build;       ///< the host's
  PicturesPhase pictures;  ///< all of them; other phases are decided as the job goes
  AssignmentPolicy policy = AssignmentPolicy::on_demand;
  Wire wire = Wire::block;
  bool compresses = true;  ///< blocks, whose pixels are RGB8
  int processors = 1;
  double host_timeout_s = liveness::kLongSilence_s;  ///< a node ends if its host is silent for so long
  double beat_s = liveness::kBeat_s;                 ///< of the hearts of all (see liveness::beat_s)
  SetPattern sets = SetPattern::lattice;             ///< interleaved: of each node's own subpolygons
  bool rotates = true;                               ///< interleaved: sets move on from step to step
  double ray_time_s = 0;                             ///< emulated processors: what a ray takes at least
  std::vector<double> time_factors;  ///< of the processors, in turn: 2 takes twice as long; empty: all 1
  Bytes settings;
};

/// How a phase is told to nodes, and what they make of it. Throws ProtocolError if the plan has no such
/// frames, or the units can't be addressed.
BeginPhase beginning_of(const Phase& phase, uint32_t number, uint64_t data_bytes);
Phase phase_of(const JobPlan& plan, const BeginPhase& begin);

/// Interleaved: the node that does an item by itself.
NodeId owner_of(const JobPlan& plan, const PicturesPhase& phase, ItemIndex item);

/// Interleaved: where a node finds a subpolygon of its first frame's set in another frame.
SubpolygonId own_subpolygon(const JobPlan& plan, const PicturesPhase& phase, FrameIndex frame,
                            SubpolygonId of_set);

Bytes encode_plan(const JobPlan& plan);
JobPlan decode_plan(std::span<const std::byte> bytes);

}  // namespace rayfarm
