#include "host/view/state_json.h"

#include "host/files/json.h"

namespace rayfarm {
namespace {

/// Names of files and machines may be any bytes; JSON is UTF-8.
Json text(std::string value) {
  try {
    Json json(value);
    json.dump();
    return json;
  } catch (const JsonError&) {
    for (char& c : value)
      if (static_cast<unsigned char>(c) >= 0x80) c = '?';
    return value;
  }
}

Json of_node(const NodeStatus& node, double rays_per_s) {
  Json json;
  json["id"] = node.id.value();
  json["machine"] = text(node.machine);
  json["pid"] = node.pid;
  json["state"] = kNodeActivityWords[static_cast<size_t>(node.activity)];
  json["items"] = node.items;
  json["rays"] = node.rays;
  json["rays_per_s"] = rays_per_s;
  json["busy_s"] = node.busy_s;
  json["problem"] = text(node.problem);
  return json;
}

Json traffic_of(const FarmStatus& status) {
  Json json;
  json["result_bytes"] = status.result_bytes;
  json["result_pixels"] = status.result_pixels;
  json["bytes_per_pixel"] = status.result_pixels == 0 ? 0.0
                                                      : static_cast<double>(status.result_bytes) /
                                                            static_cast<double>(status.result_pixels);
  json["model_bytes_per_pixel"] = kPixelBytes;
  json["model_bytes"] = kPixelBytes * status.result_pixels;
  json["commands"] = Json::Array();
  for (const TrafficStatus& traffic : status.traffic) {
    Json command;
    command["command"] = traffic.command;
    command["messages"] = traffic.messages;
    command["bytes"] = traffic.bytes;
    json["commands"].push_back(std::move(command));
  }
  return json;
}

}  // namespace

std::string to_json(const StateOfJob& state) {
  const FarmStatus& status = *state.status;
  Json json;
  json["scene"] = text(state.scene);
  json["output"] = text(state.output);
  json["stage"] = kFarmStageWords[static_cast<size_t>(status.stage)];
  json["outcome"] = text(state.outcome);
  json["updates"] = state.updates;
  json["not_shown"] = state.dropped;
  json["width"] = state.image_px[0];
  json["height"] = state.image_px[1];
  json["window"] = Json::Array{state.window.x0, state.window.x1, state.window.y0, state.window.y1};
  json["shown_width"] = state.shown_px[0];
  json["shown_height"] = state.shown_px[1];
  json["frames_total"] = state.frames_total;
  json["frames_written"] = status.frames_written;
  json["frames_failed"] = status.frames_failed;
  json["frames"] = Json::Array();
  for (const StateOfJob::Frame& frame : state.frames) {
    Json of_frame;
    of_frame["frame"] = frame.number.value();
    of_frame["share"] = frame.share;
    json["frames"].push_back(std::move(of_frame));
  }
  json["pixels_done"] = status.pixels_done;
  json["pixels_total"] = status.pixels_total;
  json["elapsed_s"] = status.elapsed_s;
  json["eta_s"] = status.left_s ? Json(*status.left_s) : Json();
  json["rays"] = status.rays;
  json["rays_per_s"] = state.rays_per_s;
  json["zones"]["rounds"] = status.zone_rounds;
  json["zones"]["unsent"] = status.zone_unsent;
  json["zones"]["rays"] = status.zone_rays;
  json["traffic"] = traffic_of(status);
  json["nodes"] = Json::Array();
  for (size_t i = 0; i < status.nodes.size(); ++i)
    json["nodes"].push_back(
        of_node(status.nodes[i], i < state.node_rays_per_s.size() ? state.node_rays_per_s[i] : 0));
  return json.dump();
}

}  // namespace rayfarm
