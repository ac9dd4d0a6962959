#pragma once
// What the experiment on the net's load found, and the page that it writes.
#include <string>
#include <vector>

#include "host/experiments/net-load/ray_shares.h"
#include "host/experiments/net-load/subpolygon_sizes.h"

namespace rayfarm {

/// One frame on the virtual cluster.
struct NetRun {
  std::string wire;
  int processors = 1;
  double rate_bit_per_s = 0;
  double frame_s = 0;
  double metered_bytes_per_pixel = 0;  ///< by the traffic meter: commands, results, control
  double link_bytes_per_pixel = 0;     ///< as the net's links counted it, with all headers
  double net_use = 0;                  ///< share of the frame's time
  double idle = 0;                     ///< share of the processors' time
  double host_cpu_s = 0;
  double model_s = 0;       ///< Equation 4.6 with the wire's payload
  double link_model_s = 0;  ///< with the bytes on the links
  double simulated_s = 0;
  /// Share of the net's rate, step by step, from so long before the frame's first ray on.
  std::vector<double> use_over_time;
  double use_begin_s = 0, use_step_s = 0;
};

struct LoadRun {
  int nodes = 1;
  std::string net, way;
  double bytes = 0, seconds = 0;
};

struct BalanceRun {
  std::string name;
  double seconds = 0, efficiency = 0, simulated_s = 0;
};

struct NetLoadPage {
  double pixels = 0, pixel_time_s = 0;
  std::vector<LoadRun> loads;
  std::vector<NetRun> runs;
  std::vector<BalanceRun> balance;
  std::vector<SizeRun> sizes;
  std::vector<RayShares> rays;
};

/// Writes README.md, net_load.csv, net_load.json, plots and the gnuplot script that draws them into `folder`.
/// Simulates what no cluster here can show.
void write_net_load_page(const NetLoadPage& page, const std::string& folder);

}  // namespace rayfarm
