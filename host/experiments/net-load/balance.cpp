#include "host/experiments/net-load/balance.h"

#include <fmt/core.h>

#include "host/files/json.h"
#include "host/files/text_file.h"
#include "host/instrument/cost_map.h"

namespace rayfarm {

std::vector<BalanceRun> measure_balance(const LocalRuns& runs, const std::string& even_scene, int width_px) {
  std::vector<BalanceRun> balance;
  const std::string corner = std::filesystem::absolute(runs.file("corner.yaml")).string();
  std::string text =
      "# Plain floor, and glass balls in one corner of the picture.\n"
      "view: {location: [0, 0, 10], look_at: [0, 0, 0], field_of_view: 60, aspect: 1.3333333}\n"
      "frames: [1, 8]\nlights: [{position: [5, 9, 9]}]\n"
      "materials: {glass: {ambient: 0, diffuse: 0.1, reflect: 0.3, transmit: 0.6, index: 1.3}}\nscene:\n"
      "  - {polygon: {points: [[-20, -20, -3], [20, -20, -3], [20, 20, -3], [-20, 20, -3]]}}\n";
  for (int i = 0; i < 36; ++i)
    text += fmt::format("  - {{material: glass, sphere: {{center: [{}, {}, 0], radius: 0.22}}}}\n",
                        -5.3 + 0.45 * (i % 6), 4.0 - 0.45 * (i / 6));
  write_text_file(corner, text);
  struct Case {
    const char* name;
    const std::string* scene;
    int subpolygons;
    AssignmentPolicy policy;
    bool rotates;
    int frames;
    bool has_slow_node;
  };
  constexpr auto interleaved = AssignmentPolicy::interleaved, on_demand = AssignmentPolicy::on_demand;
  const Case cases[] = {
      {"even scene, 64 N subpolygons, interleaved", &even_scene, 64, interleaved, true, 1, false},
      {"even scene, N subpolygons, interleaved", &even_scene, 1, interleaved, true, 1, false},
      {"even scene, 64 N, on demand", &even_scene, 64, on_demand, true, 1, false},
      {"hard corner, 64 N, interleaved", &corner, 64, interleaved, true, 1, false},
      {"hard corner, N, interleaved", &corner, 1, interleaved, true, 1, false},
      {"hard corner, 64 N, on demand", &corner, 64, on_demand, true, 1, false},
      {"hard corner, N, 8 frames, no rotation", &corner, 1, interleaved, false, 8, false},
      {"hard corner, N, 8 frames, rotation", &corner, 1, interleaved, true, 8, false},
      {"hard corner, 64 N, 8 frames, no rotation", &corner, 64, interleaved, false, 8, false},
      {"hard corner, 64 N, 8 frames, rotation", &corner, 64, interleaved, true, 8, false},
      {"one of 8 at half speed, 64 N, on demand", &even_scene, 64, on_demand, true, 1, true},
      {"one of 8 at half speed, 64 N, interleaved", &even_scene, 64, interleaved, true, 1, true},
  };
  constexpr int kNodes = 8;
  constexpr double kFrame_s = 2.5;  // of one frame, if evenly spread
  int number = 0;
  for (const Case& c : cases) {
    tell_net_load(c.name);
    RenderOptions job = runs.job(*c.scene, fmt::format("balance-{}.####", ++number), width_px);
    job.stats = runs.file(fmt::format("balance-{}.json", number)).string();
    job.cost_map = runs.file(fmt::format("balance-{}.map.json", number)).string();
    job.frames = c.frames > 1 ? fmt::format("1-{}", c.frames) : "1";
    job.policy = c.policy;
    job.rotates = c.rotates;
    job.subpolygons_per_processor = c.subpolygons;
    job.local_nodes = kNodes;
    // How many rays a frame has is found out first.
    RenderOptions probe = job;
    probe.frames = "1";
    probe.output = runs.file("probe.####.png").string();
    runs.render(probe);
    const double per_frame_s = c.frames > 1 ? kFrame_s / 4 : kFrame_s;
    job.ray_time_s = per_frame_s * kNodes / count_rays(probe.stats);
    if (c.has_slow_node) job.time_factors = {1, 1, 1, 1, 1, 1, 1, 2};
    runs.render(job);
    BalanceRun run;
    run.name = c.name;
    run.seconds = JsonView::read_file(job.stats).at("time_s").at("trace").number();
    const double speed = c.has_slow_node ? kNodes - 0.5 : kNodes;
    run.efficiency = count_rays(job.stats) * job.ray_time_s / (speed * run.seconds);

    Simulation s;
    s.processors = kNodes;
    s.frames = c.frames;
    s.policy = c.policy;
    s.rotates = c.rotates;
    s.subpolygons_per_processor = c.subpolygons;
    s.form = ResultForm::compressed;
    s.least_side_px = least_side_of(s.form);
    s.messages_held = 0;
    s.rate_bit_per_s = 1e12;
    s.cost = read_cost_map(job.cost_map);
    if (c.has_slow_node) {
      // This run's map holds the slow node's times as they were; the first case's shows equal processors.
      s.time_factors = job.time_factors;
      s.cost = read_cost_map(runs.file("balance-1.map.json").string());
    }
    run.simulated_s = simulate(s).total_s;
    balance.push_back(run);
  }
  return balance;
}

}  // namespace rayfarm
