#include "host/farm/statistics.h"

#include "host/farm/report.h"
#include "host/files/json.h"
#include "host/files/text_file.h"

namespace rayfarm {
namespace {

Json to_json(const RayCounts& rays) {
  Json j;
  for (size_t i = 0; i < kRayKinds; ++i) j[kRayKindNames[i]] = rays.by_kind[i];
  return j;
}

/// Depths and what was cut; what item buffers found.
Json tree_to_json(const RayCounts& rays) {
  return Json::Object{{"average_depth", rays.average_depth()}, {"rays_cut", rays[RayTally::cut]}};
}
Json items_to_json(const RayCounts& rays) {
  return Json::Object{{"eye_rays", rays[RayTally::eye_items]},
                      {"shadow_rays", rays[RayTally::shadow_items]},
                      {"compared_eye_rays", rays[RayTally::compared]},
                      {"differing_eye_rays", rays[RayTally::differing]}};
}

Json to_json(const std::vector<NodeId>& nodes) {
  Json::Array j;
  for (const NodeId node : nodes) j.emplace_back(node.value());
  return j;
}

}  // namespace

void write_statistics(const std::string& path, const JobResult& result, const TrafficMeter& meter,
                      const JobPlan& plan, const RenderSettings& settings, int ranks) {
  Json j;
  std::string last_sha256;
  j["frames"] = Json::Array();
  for (const FrameResult& f : result.frames) {
    j["frames"].push_back(Json::Object{{"frame", f.frame.value()},
                                       {"file", f.file},
                                       {"written", f.is_written},
                                       {"problem", f.problem},
                                       {"sha256_pixels", f.sha256},
                                       {"rays", to_json(f.rays)},
                                       {"not_finite", f.not_finite},
                                       {"traced_by", to_json(f.traced_by)}});
    if (f.is_written) last_sha256 = f.sha256;
  }
  j["image"] = Json::Object{{"width", settings.crop.width()},
                            {"height", settings.crop.height()},
                            {"sha256_pixels", last_sha256},
                            {"pixel_format", name_of(settings.pixel_format)}};
  j["resumed_pixels"] = result.pixels_resumed;
  j["ranks"] = ranks;
  j["scene"] = Json::Object{{"bytes", result.scene_bytes}};
  j["nodes_lost"] = to_json(result.lost_nodes());
  j["rays"] = to_json(result.rays);
  j["ray_trees"] = tree_to_json(result.rays);
  j["item_buffers"] = items_to_json(result.rays);
  for (const Command command : kAllCommands) {
    const Traffic t = meter.total(command);
    j["traffic"][name_of(command)] = Json::Object{{"messages", t.messages}, {"bytes", t.bytes}};
  }
  const Traffic control = meter.total_control();
  j["traffic"]["control"] = Json::Object{{"messages", control.messages}, {"bytes", control.bytes}};
  j["traffic"]["bytes_per_pixel"] = bytes_per_received_pixel(result, meter);
  j["traffic"]["model_bytes_per_pixel"] = kModelBytesPerPixel;
  j["traffic"]["duplicate_results"] = result.duplicates;
  const JobTimes& t = result.times;
  j["time_s"] = Json::Object{{"load", t.load_s},           {"build", t.build_s},
                             {"broadcast", t.broadcast_s}, {"trace", t.trace_s},
                             {"write", t.write_s},         {"finish", t.finish_s},
                             {"total", t.total_s},         {"trace_began_unix", t.trace_began_unix_s},
                             {"host_cpu", t.host_cpu_s}};
  if (const ZonesResult& z = result.zones; z.stages + z.read > 0)
    j["zones"] = Json::Object{{"stages", z.stages},
                              {"rounds", z.rounds},
                              {"rays", to_json(z.rays)},
                              {"seconds", z.seconds},
                              {"data_bytes", z.data_bytes},
                              {"assignment_bytes", z.assignment_bytes},
                              {"result_bytes", z.result_bytes},
                              {"results", z.results},
                              {"retried_items", z.retried},
                              {"read_from_files", z.read}};
  j["nodes"] = Json::Array();
  for (const NodeResult& n : result.nodes)
    j["nodes"].push_back(Json::Object{{"id", n.id.value()},
                                      {"machine", n.machine},
                                      {"pid", n.pid},
                                      {"lost", n.is_lost},
                                      {"had_work", n.had_work},
                                      {"problem", n.problem},
                                      {"subpolygons", n.subpolygons},
                                      {"rays", n.rays},
                                      {"busy_s", n.busy_s},
                                      {"idle_s", result.idle_s(n)},
                                      {"zone_items", n.zone_items},
                                      {"zone_busy_s", n.zone_busy_s},
                                      {"bytes_received", meter.of_node(n.id, Direction::to_node).bytes},
                                      {"bytes_sent", meter.of_node(n.id, Direction::to_host).bytes}});
  j["assign"] = plan.policy == AssignmentPolicy::on_demand ? "on-demand" : "interleaved";
  if (plan.policy == AssignmentPolicy::interleaved)
    j["sets"] = plan.sets == SetPattern::lattice ? "lattice" : "rows";
  j["wire"] = plan.wire == Wire::block ? "block" : "pixel";
  const SubpolygonGrid& grid = plan.pictures.grid;
  j["subpolygons"] = Json::Object{{"columns", grid.columns}, {"rows", grid.rows}};
  if (grid.small_height > 0) {
    j["subpolygons"]["small_columns"] = grid.small_columns;
    j["subpolygons"]["small_rows"] = grid.small_rows;
  }

  write_text_file(path, j.dump(1) + "\n");
}

}  // namespace rayfarm
