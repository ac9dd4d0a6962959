#include "host/experiments/net-load/local_runs.h"

#include <fmt/core.h>

#include "host/experiments/page.h"
#include "host/files/json.h"

namespace rayfarm {

LocalRuns::LocalRuns(std::filesystem::path folder, const RunRender& render)
    : folder_(std::move(folder)), render_(render) {
  make_page_folder(folder_.string());
}

RenderOptions LocalRuns::job(const std::string& scene, const std::string& name, int width_px) const {
  RenderOptions job;
  job.scene = scene;
  job.output = file(name + ".png").string();
  job.stats = file(name + ".json").string();
  job.cost_map = file(name + ".map.json").string();
  job.size_px = {width_px, width_px * 3 / 4};
  job.is_quiet = true;
  job.node_timeout_s = kPatience_s;
  return job;
}

void LocalRuns::render(const RenderOptions& job) const {
  render_or_throw(render_, job);
}

double count_rays(const std::string& stats) {
  return static_cast<double>(read_ray_counts(JsonView::read_file(stats)).total());
}

void tell_net_load(const std::string& what) {
  fmt::print(stderr, "net-load: {}\n", what);
}

}  // namespace rayfarm
