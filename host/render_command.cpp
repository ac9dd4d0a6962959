#include "host/render_command.h"

#include <fmt/core.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <future>
#include <set>

#include "common/scene/camera.h"
#include "common/scene/compile.h"
#include "common/scene/settings_codec.h"
#include "host/exit_code.h"
#include "host/farm_host.h"
#include "host/interrupt.h"
#include "host/net/cost_map.h"
#include "host/output_pattern.h"
#include "host/report.h"
#include "protocol/build_identity.h"
#include "protocol/clock.h"
#include "protocol/watchdog.h"

namespace rayfarm {
namespace {

constexpr double kHelloTimeout_s = 20;
constexpr double kSilenceWhileLoading_s = 8;

/// The job can't go on; the message says why.
class JobError : public std::runtime_error {
 public:
  JobError(int code, const std::string& problem) : std::runtime_error(problem), code_(code) {}
  int code() const { return code_; }

 private:
  int code_;
};

struct LoadedScene {
  SceneDescription description;
  CompiledScene compiled;
  double load_s = 0, build_s = 0;
};

/// A scene with so many primitives takes long enough to build that its progress is shown.
constexpr uint64_t kBigScene = 200'000;

LoadedScene load(const std::string& path, const BuildOptions& build) {
  LoadedScene loaded;
  const double begin = now_s();
  loaded.description = load_scene(path);
  loaded.load_s = now_s() - begin;
  loaded.compiled = compile(loaded.description, build);
  loaded.build_s = now_s() - begin - loaded.load_s;
  return loaded;
}

/// Takes the nodes' reports while the scene loads, and keeps telling them that the host is alive.
class Reception {
 public:
  Reception(Transport& transport, JobResult& result)
      : transport_(transport), result_(result), begin_(now_s()) {
    for (int id = 1; id <= transport.node_count(); ++id) {
      result_.nodes.push_back({});
      result_.nodes.back().id = id;
    }
    heard_.assign(result_.nodes.size(), 0);
  }

  /// One turn. Throws JobError if a node is lost or of another build.
  void serve() {
    const double now = now_s();
    while (auto message = transport_.try_receive()) {
      const auto i = static_cast<size_t>(message->source) - 1;
      heard_[i] = now;
      if (message->channel != Channel::control) continue;
      const Control control = decode_control(message->bytes);
      if (const auto* hello = std::get_if<Hello>(&control)) {
        result_.nodes[i].machine = hello->machine;
        result_.nodes[i].pid = hello->pid;
        if (hello->build != build_identity())
          throw JobError(
              kRenderFailure,
              fmt::format("node {} on {} runs another build of rayfarm than the host; install the same on "
                          "every machine, for images of two builds may differ",
                          message->source, hello->machine));
      }
    }
    heartbeat_.beat(transport_);
    for (size_t i = 0; i < heard_.size(); ++i) {
      if (heard_[i] == 0 && now - begin_ > kHelloTimeout_s)
        throw JobError(kRenderFailure,
                       fmt::format("node {} was lost before it reported; the job ends", i + 1));
      if (heard_[i] != 0 && now - heard_[i] > kSilenceWhileLoading_s)
        throw JobError(kRenderFailure,
                       fmt::format("node {} on {} was lost while loading; the job ends. Start it again, "
                                   "without the machine that failed",
                                   i + 1, result_.nodes[i].machine));
    }
    if (interrupted_by() != 0) throw JobError(kStopped, "stopped before the scene was loaded");
  }

  bool all_reported() const {
    return std::all_of(heard_.begin(), heard_.end(), [](double t) { return t > 0; });
  }

 private:
  Transport& transport_;
  JobResult& result_;
  double begin_;
  Heartbeat heartbeat_;
  std::vector<double> heard_;
};

/// Found before hours of work, not after. Only the host writes, so only it looks.
void check_folder(const char* option, const std::string& file) {
  std::filesystem::path folder = std::filesystem::path(file).parent_path();
  if (folder.empty()) folder = ".";
  std::error_code ignored;
  if (!std::filesystem::is_directory(folder, ignored))
    throw JobError(kUsageError, fmt::format("{} {}: there is no folder '{}'; make it first", option, file,
                                            folder.string()));
  if (access(folder.c_str(), W_OK) != 0)
    throw JobError(kUsageError,
                   fmt::format("{} {}: the folder '{}' can't be written to; check its permissions", option,
                               file, folder.string()));
}

std::vector<int> choose_frames(const RenderOptions& options, const SceneDescription& scene) {
  if (!options.frames.empty()) return parse_frames(options.frames);
  const std::array<int, 2> range = scene.frames.value_or(std::array{0, 0});
  return parse_frames(has_frame_pattern(options.output) ? fmt::format("{}-{}", range[0], range[1])
                                                        : fmt::format("{}", range[0]));
}

RenderSettings choose_settings(const RenderOptions& options, const SceneDescription& scene) {
  RenderSettings s = options.settings;
  if (options.size_px) {
    s.width_px = (*options.size_px)[0];
    s.height_px = (*options.size_px)[1];
  } else if (scene.view.resolution_px) {
    s.width_px = (*scene.view.resolution_px)[0];
    s.height_px = (*scene.view.resolution_px)[1];
  } else {
    s.width_px = 640;
    s.height_px = std::clamp(static_cast<int>(std::lround(640 / scene.view.aspect)), 1, 65536);
  }
  s.crop = {0, 0, s.width_px, s.height_px};
  if (options.crop) {
    const auto& c = *options.crop;
    s.crop = {c[0], c[2], c[1], c[3]};
    if (c[0] < 0 || c[2] < 0 || c[0] >= c[1] || c[2] >= c[3] || c[1] > s.width_px || c[3] > s.height_px)
      throw JobError(
          kUsageError,
          fmt::format(
              "--crop {},{},{},{}: must lie inside the image of {}×{} pixels, with x0 < x1 and y0 < y1", c[0],
              c[1], c[2], c[3], s.width_px, s.height_px));
  }
  s.pixel_format = options.pixel_format.value_or(
      options.wire == Wire::pixel ? PixelFormat::rgb8 : natural_format(options.output));
  return s;
}

/// Asks every node once more. One that was killed or hung so late that its work was done by others before its
/// silence was long enough is lost all the same, and the end of MPI would wait for it.
std::vector<int> find_silent_nodes(Transport& transport, const JobResult& result) {
  constexpr double kLongest_s = 3;
  std::set<int> silent;
  for (const NodeResult& node : result.nodes)
    if (!node.is_lost) silent.insert(node.id);
  for (const int node : silent) transport.send(node, AskPresent{});
  Backoff backoff;
  for (const double begin = now_s(); !silent.empty() && now_s() - begin < kLongest_s; backoff.wait())
    while (const auto message = transport.try_receive()) {
      if (message->channel != Channel::control) continue;
      try {
        if (std::holds_alternative<Present>(decode_control(message->bytes))) silent.erase(message->source);
      } catch (const ProtocolError&) {
        // The pictures are whole: a node that sends nonsense now is as good as silent.
      }
    }
  return {silent.begin(), silent.end()};
}

/// Hung nodes keep mpirun from returning. Those on this machine are ended here, those on others by a node
/// beside them.
bool end_hung_nodes(Transport& transport, const JobResult& result) {
  bool is_any_left = false;
  const std::string here = machine_name();
  for (const NodeResult& lost : result.nodes) {
    if (!lost.is_lost || lost.pid == static_cast<uint32_t>(getpid())) continue;
    if (lost.machine == here) {
      end_hung_process(lost.pid);
      continue;
    }
    const auto neighbour = std::find_if(result.nodes.begin(), result.nodes.end(), [&](const NodeResult& n) {
      return !n.is_lost && n.machine == lost.machine;
    });
    if (neighbour != result.nodes.end())
      transport.send(neighbour->id, EndProcess{lost.pid});
    else
      is_any_left = true;
  }
  return is_any_left;
}

class RenderCommand {
 public:
  RenderCommand(const RenderOptions& options, Farm& farm) : options_(options), farm_(farm) {
    log_ = spdlog::stderr_color_mt("rayfarm");
    log_->set_pattern("rayfarm: %v");
    log_->set_level(options.is_quiet     ? spdlog::level::err
                    : options.is_verbose ? spdlog::level::debug
                                         : spdlog::level::info);
    begin_ = now_s();
  }
  ~RenderCommand() { spdlog::drop("rayfarm"); }
  RenderCommand(const RenderCommand&) = delete;
  RenderCommand& operator=(const RenderCommand&) = delete;

  Ending run() {
    Ending ending;
    try {
      ending.exit_code = render();
    } catch (const JobError& e) {
      log_->error(e.what());
      ending.exit_code = e.code();
    } catch (const InputError& e) {
      log_->error(e.what());
      ending.exit_code = kSceneError;
    } catch (const IoError& e) {
      log_->error(e.what());
      ending.exit_code = is_loaded_ ? kRenderFailure : kSceneError;
    } catch (const std::bad_alloc&) {
      log_->error("out of memory; a smaller --size, or a machine with more memory, is needed");
      ending.exit_code = kRenderFailure;
    } catch (const std::exception& e) {
      log_->error(e.what());
      ending.exit_code = kRenderFailure;
    }
    if (is_loaded_) ending.has_hung_nodes = end_hung_nodes(farm_.transport, result_);
    ending.has_losses = !result_.lost_nodes().empty();
    farm_.transport.broadcast(Channel::control, encode_control(Finish{ending.has_losses}));
    // The last messages leave before the process does; nodes end within a poll.
    for (int i = 0; i < 20; ++i) {
      while (farm_.transport.try_receive()) {
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return ending;
  }

 private:
  int render() {
    check_folder("-o", options_.output);
    if (!options_.stats.empty()) check_folder("--stats", options_.stats);
    Reception reception(farm_.transport, result_);
    BuildProgress building;
    std::future<LoadedScene> loading =
        std::async(std::launch::async, load, options_.scene,
                   BuildOptions{options_.split_rule, options_.max_primitives, &building});
    Progress progress(options_.is_quiet ? ProgressStyle::none : options_.progress);
    const double begin = now_s();
    Backoff backoff;
    while (!loaded_ || !reception.all_reported()) {
      // A scene that can't be loaded ends the job at once, whoever has reported.
      if (!loaded_ && loading.wait_for(std::chrono::seconds(0)) == std::future_status::ready)
        loaded_ = loading.get();
      reception.serve();
      if (building.total >= kBigScene) progress.show_building(now_s() - begin, building.done, building.total);
      backoff.wait();
    }
    progress.clear();
    return render_loaded();
  }

  int render_loaded() {
    const SceneDescription& scene = loaded_->description;
    result_.times.load_s = loaded_->load_s;
    result_.times.build_s = loaded_->build_s;
    for (const std::string& note : loaded_->compiled.notes.lines()) log_->warn(note);

    FarmHostOptions farm_options;
    JobPlan& plan = farm_options.plan;
    const RenderSettings settings = choose_settings(options_, scene);
    plan.build = build_identity();
    plan.policy = options_.policy;
    plan.wire = options_.wire;
    plan.compresses = options_.compresses;
    plan.processors = farm_.transport.node_count();
    plan.settings = encode_settings(settings);
    plan.grid = make_grid(settings.crop.x0, settings.crop.y0, settings.crop.width(), settings.crop.height(),
                          plan.processors, options_.subpolygons_per_processor);
    plan.rotates = options_.rotates;
    plan.ray_time_s = options_.ray_time_s;
    // Who waits longer for nodes has a slower net, on which nodes wait longer for their host.
    plan.host_timeout_s = std::max(plan.host_timeout_s, options_.node_timeout_s - 2);
    plan.time_factors = options_.time_factors;
    for (const int frame : choose_frames(options_, scene)) {
      const std::string file = file_of_frame(options_.output, frame);
      if (options_.skip_existing && std::filesystem::exists(file)) {
        log_->info("{} is there; frame {} is skipped", file, frame);
        continue;
      }
      try {
        make_camera(loaded_->compiled.scene, frame, settings.width_px, settings.height_px);
      } catch (const std::domain_error& e) {
        throw InputError({options_.scene}, fmt::format("at frame {}: {}", frame, e.what()));
      }
      plan.frames.push_back(frame);
      farm_options.files.push_back(file);
    }
    if (plan.frames.empty()) {
      log_->info("nothing to do");
      return kComplete;
    }
    if (options_.wire == Wire::pixel && natural_format(options_.output) != PixelFormat::rgb8)
      log_->warn("the pixel wire carries 8 bits a channel: the EXR holds no more than that");
    log_->debug("{} nodes, {} × {} subpolygons", plan.processors, plan.grid.columns, plan.grid.rows);

    const double broadcast_begin = now_s();
    farm_.transport.broadcast(Channel::command, encode_load_code(encode_plan(plan)));
    farm_.load_data(loaded_->compiled.block.bytes(), [this](const std::string& text) { log_->warn(text); });
    is_loaded_ = true;
    result_.times.broadcast_s = now_s() - broadcast_begin;
    log_->debug("the scene is loaded everywhere; tracing begins");

    farm_options.image = {settings.width_px, settings.height_px, settings.crop, settings.pixel_format, {}};
    farm_options.attributes = {{"rayfarm/version", RAYFARM_VERSION},
                               {"rayfarm/seed", fmt::format("{}", settings.seed)},
                               {"rayfarm/samples", fmt::format("{}", settings.samples)}};
    farm_options.node_timeout_s = options_.node_timeout_s;
    farm_options.progress = options_.is_quiet ? ProgressStyle::none : options_.progress;
    {
      FarmHost host(farm_.transport, farm_options, result_,
                    [this](const std::string& text) { log_->warn(text); });
      host.run();
    }
    result_.times.total_s = now_s() - begin_;
    for (const int node : find_silent_nodes(farm_.transport, result_))
      result_.nodes[static_cast<size_t>(node) - 1].is_lost = true;
    return report(plan, settings);
  }

  int report(const JobPlan& plan, const RenderSettings& settings) {
    const TrafficMeter& meter = *farm_.transport.meter();
    for (const int node : result_.lost_nodes()) log_->warn("node {} was lost", node);
    if (!options_.stats.empty())
      write_statistics(options_.stats, result_, meter, plan, settings, farm_.ranks);
    if (!options_.cost_map.empty()) write_cost_map(options_.cost_map, result_, plan.grid);
    if (!options_.is_quiet) fmt::print(stderr, "{}", format_report(result_, meter, plan));
    for (const FrameResult& frame : result_.frames)
      if (frame.is_written) fmt::print("{}\n", frame.file);
    std::fflush(stdout);
    if (result_.was_interrupted)
      throw JobError(kStopped, "stopped; finished frames are in place (--skip-existing goes on from there)");
    if (result_.lost_all_nodes) throw JobError(kRenderFailure, "every node is lost");
    if (result_.frames_failed() == 0) return kComplete;
    for (const FrameResult& frame : result_.frames)
      if (!frame.problem.empty()) log_->error("frame {} failed: {}", frame.frame, frame.problem);
    return result_.frames_failed() == result_.frames.size() ? kRenderFailure : kSomeFramesFailed;
  }

  const RenderOptions& options_;
  Farm& farm_;
  std::shared_ptr<spdlog::logger> log_;
  JobResult result_;
  std::optional<LoadedScene> loaded_;
  bool is_loaded_ = false;
  double begin_ = 0;
};

}  // namespace

Ending run_render(const RenderOptions& options, Farm& farm) {
  return RenderCommand(options, farm).run();
}

}  // namespace rayfarm
