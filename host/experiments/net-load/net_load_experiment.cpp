#include "host/experiments/net-load/net_load_experiment.h"

#include <fmt/core.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "host/experiments/net-load/balance.h"
#include "host/files/json.h"
#include "host/files/text_file.h"
#include "host/instrument/cost_map.h"
#include "host/instrument/model.h"
#include "host/process/exit_code.h"
#include "protocol/messages.h"

namespace rayfarm {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth_px = 512;
constexpr double kKnee = 12;              ///< processors that are to fill the net
constexpr double kMessagePayload = 1448;  ///< of TCP in an Ethernet frame

std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? "'\\''" : std::string(1, c);
  return out + "'";
}

/// A size of the picture, with what its pixels take and weigh: found out before anything is emulated.
struct Setup {
  int width_px = kWidth_px;
  double plateau_s = 4;  ///< what a frame is to take when the net is full
  double pixels = 0, rays_per_pixel = 0, compressed_bytes = 0;

  /// So that kKnee processors fill a net that takes plateau_s for a frame.
  double pixel_time_s() const { return kKnee * plateau_s / pixels; }
  double rate_of(double bytes_per_pixel) const {
    return 8 * std::round(pixels * bytes_per_pixel / plateau_s);
  }
};

/// Bytes on the net over Unix time, as the cluster sampled them.
class Samples {
 public:
  explicit Samples(const fs::path& path) {
    std::ifstream file(path);
    std::string line;
    std::getline(file, line);
    while (std::getline(file, line))
      if (const size_t comma = line.find(','); comma != std::string::npos)
        points_.push_back({std::atof(line.c_str()), std::atof(line.c_str() + comma + 1)});
  }
  double bytes_between(double begin, double end) const { return bytes_at(end) - bytes_at(begin); }

 private:
  /// Linear between samples.
  double bytes_at(double time) const {
    for (size_t i = 1; i < points_.size(); ++i) {
      const auto [t0, b0] = points_[i - 1];
      const auto [t1, b1] = points_[i];
      if (time <= t1 && t1 > t0) return b0 + std::clamp((time - t0) / (t1 - t0), 0.0, 1.0) * (b1 - b0);
    }
    return points_.empty() ? 0 : points_.back()[1];
  }
  std::vector<std::array<double, 2>> points_;  ///< time, bytes
};

class NetLoad {
 public:
  NetLoad(const ExperimentOptions& options, const RunRender& render)
      : options_(options), runs_(fs::path(options.output) / "runs", render) {
    if (options.width_px > 0) setup_.width_px = options.width_px;
    scene_ = fs::absolute(fs::path(options.scenes) / "primitives.yaml").string();
  }

  NetLoadPage run() {
    page_.rays = measure_ray_shares(runs_, options_.scenes, setup_.width_px);
    page_.sizes = measure_sizes(runs_, scene_, setup_.width_px / 2);
    calibrate(setup_);
    measure_loading();
    measure_knees();
    page_.balance = measure_balance(runs_, scene_, setup_.width_px / 2);
    page_.pixels = setup_.pixels;
    page_.pixel_time_s = setup_.pixel_time_s();
    return std::move(page_);
  }

 private:
  void calibrate(Setup& setup) const {
    tell_net_load("calibrating");
    RenderOptions job = runs_.job(scene_, "calibration", setup.width_px);
    job.local_nodes = 16;
    runs_.render(job);
    setup.pixels = double(setup.width_px) * (setup.width_px * 3 / 4);
    setup.rays_per_pixel = count_rays(job.stats) / setup.pixels;
    setup.compressed_bytes = JsonView::read_file(job.stats).at("traffic").at("bytes_per_pixel").number();
  }

  /// Runs a render across the virtual cluster.
  JsonView render_on_cluster(const Setup& setup, const std::string& name, int nodes, double rate,
                             const std::string& scene, const std::string& arguments,
                             const std::string& net = "bus", const std::string& environment = "") const {
    const fs::path runs = fs::absolute(runs_.file(""));
    const std::string stats = (runs / (name + ".json")).string();
    const std::string command = fmt::format(
        "{}{} --nodes {} --rate {:.0f}bit --net {} --counters {} --samples {} -- {} render {} -o {} --stats "
        "{} --cost-map {} --size {}x{} --node-timeout {} -q {} >/dev/null",
        environment, quoted(options_.cluster), nodes, rate, net,
        quoted((runs / (name + ".links.json")).string()), quoted((runs / (name + ".samples.csv")).string()),
        quoted(fs::read_symlink("/proc/self/exe").string()), quoted(scene),
        quoted((runs / (name + ".png")).string()), quoted(stats),
        quoted((runs / (name + ".map.json")).string()), setup.width_px, setup.width_px * 3 / 4, kPatience_s,
        arguments);
    const int status = std::system(command.c_str());
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
      fmt::print(stderr, "rayfarm: the run '{}' on the virtual cluster failed\n", name);
      throw RenderFailed{WIFEXITED(status) ? WEXITSTATUS(status) : kStopped};
    }
    return JsonView::read_file(stats);
  }

  /// A scene whose block has about so many bytes: spheres, with their part of the hierarchy.
  std::string write_heavy_scene(const std::string& name, double bytes) const {
    constexpr double kBytesPerSphere = 97;
    const std::string path = fs::absolute(runs_.file(name + ".nff")).string();
    std::string text =
        "v\nfrom 0 0 9\nat 0 0 0\nup 0 1 0\nangle 40\nhither 1\nresolution 64 48\nb 0 0 0\nl 5 5 5\n"
        "f 0.5 0.5 0.5 1 0 0 0 1\n";
    for (int i = 0; i < static_cast<int>(bytes / kBytesPerSphere); ++i)
      text += fmt::format("s {} {} {} 0.01\n", i % 100 * 0.05 - 2.5, i / 100 % 100 * 0.05 - 2.5,
                          -(i / 10000) * 0.1);
    write_text_file(path, text);
    return path;
  }

  /// Ten megabytes to one node, and to two; and one megabyte to eight, by several ways. All at 8 Mbit/s.
  void measure_loading() {
    const double share = std::min(1.0, double(setup_.width_px) / kWidth_px);
    const std::string large = write_heavy_scene("load", 10e6 * share),
                      small = write_heavy_scene("load-small", 1e6 * share);
    struct Case {
      int nodes;
      const std::string* scene;
      const char *net, *way;
      int algorithm;  ///< of Open MPI's broadcast; 0: its own choice
    };
    for (const Case& c :
         {Case{1, &large, "bus", "as Open MPI likes", 0}, Case{2, &large, "bus", "as Open MPI likes", 0},
          Case{8, &small, "bus", "one after the other", 1}, Case{8, &small, "bus", "binomial tree", 6},
          Case{8, &small, "switch", "one after the other", 1}, Case{8, &small, "switch", "binomial tree", 6},
          Case{8, &small, "switch", "chain", 3}}) {
      tell_net_load(fmt::format("loading {} nodes, {}, {}", c.nodes, c.net, c.way));
      const std::string environment =
          c.algorithm == 0
              ? ""
              : fmt::format(
                    "OMPI_MCA_coll_tuned_use_dynamic_rules=1 OMPI_MCA_coll_tuned_bcast_algorithm={} "
                    "OMPI_MCA_coll_tuned_bcast_algorithm_segmentsize=8192 ",
                    c.algorithm);
      const JsonView stats =
          render_on_cluster(setup_, fmt::format("load-{}-{}-{}", c.nodes, c.net, c.algorithm), c.nodes, 8e6,
                            *c.scene, "--crop 0,8,0,8", c.net, environment);
      page_.loads.push_back({c.nodes, c.net, c.way,
                             stats.at("traffic").at(name_of(Command::load_data)).at("bytes").number(),
                             stats.at("time_s").at("broadcast").number()});
    }
  }

  void measure_knees() {
    const std::vector<int> processors{4, 8, 12, 18, 24, 32};
    sweep(setup_, "pixel", kPixelBytes, setup_.rate_of(kPixelBytes), processors, "--wire pixel",
          ResultForm::pixels);
    sweep(setup_, "block", 3, setup_.rate_of(3), processors, "--compression none", ResultForm::blocks);
    // On one net, at twice the resolution: blocks of a few hundred pixels, as the thesis's picture has them.
    Setup large{2 * setup_.width_px, 2 * setup_.plateau_s, 0, 0, 0};
    calibrate(large);
    const double rate = large.rate_of(kPixelBytes);
    sweep(large, "pixel, large", kPixelBytes, rate, {32}, "--wire pixel", ResultForm::pixels);
    sweep(large, "compressed, large", large.compressed_bytes, rate, {8, 16, 32}, "", ResultForm::compressed);
    sweep(large, "compressed, large, on demand", large.compressed_bytes, rate, {32}, "--assign on-demand",
          ResultForm::compressed);
  }

  void sweep(const Setup& setup, const std::string& wire, double bytes_per_pixel, double rate,
             const std::vector<int>& processors, const std::string& arguments, ResultForm form) {
    const bool is_on_demand = arguments.find("on-demand") != std::string::npos;
    for (const int n : processors) {
      tell_net_load(fmt::format("{} wire, {} processors", wire, n));
      std::string name = fmt::format("{}-{}", wire, n);
      std::replace_if(
          name.begin(), name.end(), [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '-');
      const JsonView stats = render_on_cluster(
          setup, name, n, rate, scene_,
          fmt::format("--processor-time {:.9g} {} {}", setup.pixel_time_s() / setup.rays_per_pixel, arguments,
                      is_on_demand ? "" : "--assign interleaved"));
      NetRun run;
      run.wire = wire;
      run.processors = n;
      run.rate_bit_per_s = rate;
      run.frame_s = stats.at("time_s").at("trace").number();
      run.host_cpu_s = stats.at("time_s").at("host_cpu").number();
      const JsonView traffic = stats.at("traffic");
      double metered = traffic.at("control").at("bytes").number();
      for (const Command c : {Command::load_display_polygon, Command::return_result})
        metered += traffic.at(name_of(c)).at("bytes").number();
      run.metered_bytes_per_pixel = metered / setup.pixels;
      const double began = stats.at("time_s").at("trace_began_unix").number();
      const Samples samples(runs_.file(name + ".samples.csv"));
      const double link_bytes = samples.bytes_between(began, began + run.frame_s);
      run.link_bytes_per_pixel = link_bytes / setup.pixels;
      run.net_use = 8 * link_bytes / (rate * run.frame_s);
      double busy = 0;
      for (const JsonView& node : stats.at("nodes").elements()) busy += node.at("busy_s").number();
      run.idle = 1 - busy / (n * run.frame_s);

      NetModel model;
      model.rate_bit_per_s = rate;
      model.pixels = setup.pixels;
      model.pixel_time_s = busy / setup.pixels;
      const WireModel payload{wire, bytes_per_pixel, 0}, links{wire, run.link_bytes_per_pixel, 0};
      run.model_s = evaluate(model, payload, n).next_frame_s;
      run.link_model_s = evaluate(model, links, n).next_frame_s;

      Simulation s;
      s.processors = n;
      s.policy = is_on_demand ? AssignmentPolicy::on_demand : AssignmentPolicy::interleaved;
      s.form = form;
      s.pixels_per_message = static_cast<int>(kPixelsPerTransfer);
      s.messages_held = 0;
      s.least_side_px = least_side_of(s.form);
      s.rate_bit_per_s = rate;
      s.cost = read_cost_map(runs_.file(name + ".map.json").string());
      const double plain = simulate(s).bytes;
      // What frames, acknowledgements and control messages add, as the links show it, on every packet.
      s.packet_bytes = kMessagePayload;
      s.message_bytes = 1;
      const double packets = simulate(s).bytes - plain;
      s.message_bytes = std::max(0.0, (link_bytes - plain) / packets);
      run.simulated_s = simulate(s).total_s;
      constexpr double kStep_s = 0.2;
      for (double t = -4 * kStep_s; t < run.frame_s + 4 * kStep_s; t += kStep_s)
        run.use_over_time.push_back(8 * samples.bytes_between(began + t, began + t + kStep_s) /
                                    (rate * kStep_s));
      run.use_begin_s = -4 * kStep_s;
      run.use_step_s = kStep_s;
      page_.runs.push_back(run);
    }
  }

  const ExperimentOptions& options_;
  LocalRuns runs_;
  Setup setup_;
  std::string scene_;
  NetLoadPage page_;
};

}  // namespace

int run_net_load_experiment(const ExperimentOptions& options, const RunRender& render) {
  if (geteuid() != 0) {
    fmt::print(stderr, "rayfarm: the virtual cluster's network namespaces need root; run this as root\n");
    return kRenderFailure;
  }
  if (!fs::exists(options.cluster)) {
    fmt::print(stderr, "rayfarm: {} is not there; run this in Rayfarm's folder, or name it with --cluster\n",
               options.cluster);
    return kSceneError;
  }
  try {
    const NetLoadPage page = NetLoad(options, render).run();
    write_net_load_page(page, options.output);
  } catch (const RenderFailed& failed) {
    return failed.code;
  }
  fmt::print("{}\n", (fs::path(options.output) / "README.md").string());
  return kComplete;
}

}  // namespace rayfarm
