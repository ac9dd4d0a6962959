#include "host/experiments/zones/zone_farms.h"

#include <fmt/core.h>

#include <fstream>

#include "common/files/sha256.h"
#include "common/lighting/zones/zone_scene.h"
#include "host/experiments/page.h"
#include "host/experiments/renders.h"
#include "host/instrument/model.h"

namespace rayfarm {
namespace {

constexpr double kSize = 0.1, kRays = 1e6;
/// Of emulated processors, so slow that two cores can be nine of them.
constexpr double kRayTime_s = 4e-6;

struct FarmOfZones {
  int nodes = 0;
  std::string file_sha256, picture_sha256;
  double seconds = 0, rays = 0, stages = 0, rounds = 0, data_bytes = 0, result_bytes = 0;
};

std::string sha256_of_file(const std::string& name) {
  std::ifstream in(name, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  return sha256(std::as_bytes(std::span(text)));
}

FarmOfZones run_farm(const ZoneWork& work, const RunRender& render, int nodes, uint32_t batch,
                     AssignmentPolicy policy) {
  RenderOptions job;
  job.scene = work.path_of("goral_room.yaml");
  job.output = work.scratch("farm.exr").string();
  job.stats = work.scratch("farm.json").string();
  job.zones_file = work.scratch(fmt::format("farm-{}-{}.zones", nodes, batch)).string();
  std::filesystem::remove(job.zones_file);
  job.size_px = {16, 16};
  job.settings = zone_experiment_settings(LightingModel::zonal, 1);
  job.max_depth = kPathDepth;
  job.settings.zones.size = work.size(kSize);
  job.settings.zones.rays = work.rays(kRays);
  job.settings.zones.batch = batch;
  job.policy = policy;
  job.local_nodes = nodes;
  job.ray_time_s = kRayTime_s;
  job.is_quiet = true;
  render_or_throw(render, job);
  const JsonView stats = JsonView::read_file(job.stats), zones = stats.at("zones");
  FarmOfZones farm;
  farm.nodes = nodes;
  farm.file_sha256 = sha256_of_file(job.zones_file);
  farm.picture_sha256 = stats.at("image").at("sha256_pixels").text();
  farm.seconds = zones.at("seconds").number();
  farm.rays = static_cast<double>(read_ray_counts(zones).total());
  farm.stages = zones.at("stages").number();
  farm.rounds = zones.at("rounds").number();
  farm.data_bytes = zones.at("data_bytes").number();
  farm.result_bytes = zones.at("result_bytes").number();
  return farm;
}

}  // namespace

ZoneStudy study_zone_farms(const ZoneWork& work, const RunRender& render) {
  struct Case {
    int nodes;
    uint32_t batch;
    AssignmentPolicy policy;
  };
  constexpr auto on_demand = AssignmentPolicy::on_demand, interleaved = AssignmentPolicy::interleaved;
  std::vector<FarmOfZones> farms;
  for (const Case& c : {Case{1, 4096, on_demand}, Case{2, 1000, interleaved}, Case{3, 4096, on_demand},
                        Case{9, 1000, on_demand}}) {
    tell_zones(fmt::format("{} nodes", c.nodes));
    farms.push_back(run_farm(work, render, c.nodes, c.batch, c.policy));
  }
  RenderSettings settings = zone_experiment_settings(LightingModel::zonal, 1);
  settings.zones.size = work.size(kSize);
  const double zones =
      static_cast<double>(ZoneScene(work.scene("goral_room.yaml").scene(), settings, 0).slot_count());
  Table table{"ranks",
              {"nodes", "zones_sha256", "picture_sha256", "rays", "seconds", "model_s", "data_bytes",
               "24_n_rounds", "result_bytes", "at_1_gbit_s", "at_8_mbit_s"},
              {}};
  bool is_same = true;
  double worst = 0;
  std::string data;
  for (const FarmOfZones& farm : farms) {
    NetModel model;
    model.zones = {zones, farm.stages, farm.rays / farm.stages, kRayTime_s, farm.result_bytes / farm.stages};
    const auto seconds = [&](double rate) {
      model.rate_bit_per_s = rate;
      return evaluate_zones(model, farm.nodes).total_s();
    };
    const double own = seconds(1e15);  // within one process
    table.rows.push_back({double(farm.nodes), farm.file_sha256.substr(0, 12),
                          farm.picture_sha256.substr(0, 12), farm.rays, farm.seconds, own, farm.data_bytes,
                          kZoneBytes * zones * farm.stages, farm.result_bytes, seconds(1e9), seconds(8e6)});
    data += fmt::format("{} {} {} {} {}\n", farm.nodes, farm.seconds, own, seconds(1e9), seconds(8e6));
    is_same =
        is_same && farm.file_sha256 == farms[0].file_sha256 && farm.picture_sha256 == farms[0].picture_sha256;
    worst = std::max(worst, std::abs(farm.seconds / own - 1));
  }
  ZoneStudy study;
  study.checks.push_back(
      {"solution and picture on 1, 2, 3, 9 nodes, batches of 4096 and 1000 rays, both policies",
       "the same bytes", is_same ? "the same SHA-256" : "different", is_same});
  study.checks.push_back({"time of the light on 1, 2, 3, 9 nodes", "rounds · rays · T_R / N, no net",
                          fmt::format("{} off at the most", percent(worst)), worst < 0.25});
  study.section =
      fmt::format(
          "\n## Ranks\n\n"
          "Goral's room, {:.2g} wide zones, {} rays of the first round, on nodes that take {:.2g} µs for a "
          "ray "
          "(`--processor-time`), asleep, in one process: two cores are nine of them. The model is "
          "T = rounds (24 n / W + rays T_R / N + results / W) with n sums of zones on a net of W bytes/s; "
          "within "
          "a process W has no end. The last two columns are the model's on nets of 1 Gbit/s and of the "
          "thesis's "
          "8 Mbit/s. A stage tells of what has something to send in as few bytes as it takes, and the "
          "solution "
          "goes to all nodes once more, so that the data's bytes differ from the model's 24 n.\n\n",
          work.size(kSize), work.rays(kRays), 1e6 * kRayTime_s) +
      markdown(table) + "\n![time of the light over nodes](ranks.svg)\n";
  study.data["ranks.dat"] = data;
  study.tables.push_back(std::move(table));
  return study;
}

}  // namespace rayfarm
