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
  if (const int code = render_(job); code != 0) throw RenderFailed{code};
}

double count_rays(const std::string& stats) {
  double rays = 0;
  for (const JsonView& count : JsonView::read_file(stats).at("rays").elements()) rays += count.number();
  return rays;
}

void tell_net_load(const std::string& what) {
  fmt::print(stderr, "net-load: {}\n", what);
}

}  // namespace rayfarm
