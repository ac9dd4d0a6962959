#include "host/farm/watching.h"

#include "host/farm/report.h"

namespace rayfarm {

FarmStatus status_of(const JobResult& result, const TrafficMeter& meter, const Assignment& assignment) {
  FarmStatus status;
  status.pixels_done = result.pixels_kept;
  status.rays = result.rays.total();
  for (const FrameResult& frame : result.frames) status.frames_written += frame.is_written ? 1u : 0u;
  status.frames_failed = result.frames_failed();
  status.result_bytes = picture_result_bytes(result, meter);
  status.result_pixels = result.pixels_received;
  for (const Command command : kAllCommands) {
    const Traffic total = meter.total(command);
    status.traffic.push_back({name_of(command), total.messages, total.bytes});
  }
  const Traffic control = meter.total_control();
  status.traffic.push_back({"control", control.messages, control.bytes});
  status.nodes.reserve(result.nodes.size());
  for (const NodeResult& node : result.nodes) {
    const NodeActivity activity = !node.problem.empty()          ? NodeActivity::failed
                                  : node.is_lost                 ? NodeActivity::lost
                                  : assignment.has_work(node.id) ? NodeActivity::working
                                                                 : NodeActivity::waiting;
    status.nodes.push_back({node.id, node.machine, node.pid, activity, node.subpolygons + node.zone_items,
                            node.rays, node.busy_s + node.zone_busy_s, node.problem});
  }
  return status;
}

}  // namespace rayfarm
