#include "host/render_command.h"

#include <fmt/core.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <filesystem>
#include <future>

#include "common/compile/compile.h"
#include "common/scene/camera.h"
#include "common/scene/settings_codec.h"
#include "host/console.h"
#include "host/exit_code.h"
#include "host/farm_host.h"
#include "host/interrupt.h"
#include "host/memory.h"
#include "host/net/cost_map.h"
#include "host/output_pattern.h"
#include "host/outputs.h"
#include "host/report.h"
#include "host/roll_call.h"
#include "protocol/build_identity.h"
#include "protocol/clock.h"

namespace rayfarm {
namespace {

struct LoadedScene {
  SceneDescription description;
  CompiledScene compiled;
  double load_s = 0, build_s = 0;
};

/// A scene with so many primitives takes long enough to build that its progress is shown.
constexpr uint64_t kBigScene = 200'000;

/// A scene that is being loaded by another thread; stops it when it is no longer wanted.
class SceneLoading {
 public:
  SceneLoading(const std::string& path, const BuildOptions& build)
      : future_(std::async(std::launch::async | std::launch::deferred, load, path, build, &progress_,
                           stop_.get_token())) {}
  ~SceneLoading() { stop_.request_stop(); }
  SceneLoading(const SceneLoading&) = delete;
  SceneLoading& operator=(const SceneLoading&) = delete;

  /// Also if the system refuses a thread: then `take` loads.
  bool is_ready() const { return future_.wait_for(std::chrono::seconds(0)) != std::future_status::timeout; }
  /// Once, when it is ready. Throws what loading threw.
  LoadedScene take() { return future_.get(); }
  const BuildProgress& progress() const { return progress_; }

 private:
  static LoadedScene load(const std::string& path, BuildOptions build, BuildProgress* progress,
                          std::stop_token stop) {
    LoadedScene loaded;
    const double begin = now_s();
    loaded.description = load_scene(path, stop);
    loaded.load_s = now_s() - begin;
    build.progress = progress;
    build.stop = std::move(stop);
    loaded.compiled = compile(loaded.description, build);
    loaded.build_s = now_s() - begin - loaded.load_s;
    return loaded;
  }

  BuildProgress progress_;
  std::stop_source stop_;
  std::future<LoadedScene> future_;  // last: its end waits for the thread
};

std::vector<int> choose_frames(const RenderOptions& options, const SceneDescription& scene) {
  if (!options.frames.empty()) return parse_frames(options.frames);
  const std::array<int, 2> range = scene.frames.value_or(std::array{0, 0});
  return parse_frames(has_frame_pattern(options.output) ? fmt::format("{}-{}", range[0], range[1])
                                                        : fmt::format("{}", range[0]));
}

RenderSettings choose_settings(const RenderOptions& options, const SceneDescription& scene) {
  RenderSettings s = options.settings;
  const std::array<int, 2> size = options.size_px.value_or(scene.view.size_px());
  s.width_px = size[0];
  s.height_px = size[1];
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

/// Frames that are begun but not written: so many fit into memory beside `other_bytes` that are still to be
/// taken, at most as many as are of use. Throws JobError if not even one does.
int choose_window(const RenderSettings& settings, size_t frames, size_t other_bytes) {
  constexpr int kMostFrames = 3;
  constexpr double kShare = 0.9;  // of what is free: files are written through buffers
  const double frame_bytes = static_cast<double>(settings.crop.area()) *
                             static_cast<double>(make_pixel_layout(settings.pixel_format).bytes);
  const uint64_t free_bytes = available_memory_bytes();
  const auto available = static_cast<double>(free_bytes - std::min<uint64_t>(other_bytes, free_bytes));
  const double fit = kShare * available / frame_bytes;
  if (fit < 1)
    throw JobError(
        kRenderFailure,
        fmt::format("a frame of {}×{} pixels as {} takes {:.2f} GiB on the host, of which {:.2f} GiB "
                    "are free; render parts of it (--crop), or take a smaller --pixel-format",
                    settings.crop.width(), settings.crop.height(), name_of(settings.pixel_format),
                    frame_bytes / (1 << 30), available / (1 << 30)));
  return static_cast<int>(std::min({double(kMostFrames), double(frames), fit}));
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
    farm_.wait_for_nodes();  // they may still trace in the scene that ends with this object
    return ending;
  }

 private:
  int render() {
    check_outputs(options_);
    note_idle_options();
    RollCall roll_call(farm_.transport, result_);
    load(roll_call);
    return render_loaded(roll_call);
  }

  void load(RollCall& roll_call) {
    SceneLoading loading(options_.scene,
                         {.rule = options_.split_rule, .max_primitives = options_.max_primitives});
    Progress progress(options_.is_quiet ? ProgressStyle::none : options_.progress);
    const double begin = now_s();
    Backoff backoff;
    while (!loaded_ || !roll_call.all_reported()) {
      // A scene that can't be loaded ends the job at once, whoever has reported.
      if (!loaded_ && loading.is_ready()) loaded_ = loading.take();
      roll_call.serve();
      const BuildProgress& building = loading.progress();
      if (building.total >= kBigScene) progress.show_building(now_s() - begin, building.done, building.total);
      backoff.wait();
    }
    progress.clear();
  }

  /// Options that do nothing beside others are said.
  void note_idle_options() const {
    const RenderSettings& s = options_.settings;
    const RenderSettings usual;
    if (s.lighting != LightingModel::thesis &&
        (s.diffuse_rays != usual.diffuse_rays || s.diffuse_reach != usual.diffuse_reach ||
         s.diffuse_contrast != usual.diffuse_contrast || s.diffuse_jitter))
      log_->warn("the --diffuse options belong to --lighting thesis, and do nothing here");
    if (options_.policy == AssignmentPolicy::on_demand && !options_.rotates)
      log_->warn("--no-rotation belongs to --assign interleaved, and does nothing here");
    if (options_.local_nodes > 0 && !farm_.transport.is_one_process())
      log_->warn("--local-nodes does nothing under mpirun: every rank but the host is a node");
  }

  JobPlan make_plan(const RenderSettings& settings) const {
    JobPlan plan;
    plan.build = build_identity();
    plan.policy = options_.policy;
    plan.wire = options_.wire;
    const PixelLayout layout = make_pixel_layout(settings.pixel_format);
    plan.compresses = options_.compresses && layout.is_rgb8();
    plan.processors = farm_.transport.node_count();
    plan.settings = encode_settings(settings);
    const size_t pixel_bytes = options_.wire == Wire::pixel ? kPixelBytes : layout.bytes;
    plan.grid = make_grid(settings.crop.x0, settings.crop.y0, settings.crop.width(), settings.crop.height(),
                          plan.processors, options_.subpolygons_per_processor, kLeastSide_px,
                          kMostSubpolygonBytes / pixel_bytes);
    plan.rotates = options_.rotates;
    plan.ray_time_s = options_.ray_time_s;
    // Who waits longer for nodes has a slower net, on which nodes wait longer for their host.
    plan.host_timeout_s = std::max(plan.host_timeout_s, options_.node_timeout_s);
    plan.time_factors = options_.time_factors;
    return plan;
  }

  /// The frames to render, with their files.
  void choose_work(FarmHostOptions& farm_options, const RenderSettings& settings) {
    for (const int frame : choose_frames(options_, loaded_->description)) {
      if (interrupted_by() != 0) throw JobError(kStopped, "stopped before anything was traced");
      const std::string file = file_of_frame(options_.output, frame);
      if (options_.skip_existing && std::filesystem::exists(file)) {
        const std::string why = why_not_finished(file, settings, frame, farm_options.attributes);
        if (why.empty()) {
          log_->info("{} is there; frame {} is skipped", file, frame);
          continue;
        }
        log_->warn("{} {}; frame {} is rendered again", file, why, frame);
      }
      for (const std::string& other : {options_.stats, options_.cost_map})
        if (file == other)
          throw JobError(kUsageError,
                         fmt::format("{} is the file of frame {}, and of --stats or --cost-map; each "
                                     "output needs a name of its own",
                                     file, frame));
      try {
        make_camera(loaded_->compiled.scene, frame, settings.width_px, settings.height_px);
      } catch (const std::domain_error& e) {
        throw InputError({options_.scene}, fmt::format("at frame {}: {}", frame, e.what()));
      }
      farm_options.plan.frames.push_back(frame);
      farm_options.files.push_back(file);
    }
  }

  int render_loaded(const RollCall& roll_call) {
    result_.times.load_s = loaded_->load_s;
    result_.times.build_s = loaded_->build_s;
    result_.scene_bytes = loaded_->compiled.block.size;
    for (const std::string& note : loaded_->compiled.notes.lines()) log_->warn(note);

    const RenderSettings settings = choose_settings(options_, loaded_->description);
    FarmHostOptions farm_options;
    farm_options.plan = make_plan(settings);
    farm_options.attributes = make_attributes(settings, loaded_->compiled.block.bytes());
    choose_work(farm_options, settings);
    const JobPlan& plan = farm_options.plan;
    if (plan.frames.empty()) {
      log_->info("nothing to do");
      return kComplete;
    }
    farm_options.window_frames = choose_window(
        settings, plan.frames.size(),
        farm_.transport.is_one_process() ? 0 : loaded_->compiled.block.size);  // the machine's copy
    if (options_.wire == Wire::pixel && natural_format(options_.output) != PixelFormat::rgb8)
      log_->warn("the pixel wire carries 8 bits a channel: the EXR holds no more than that");
    log_->debug("{} nodes, {} × {} subpolygons", plan.processors, plan.grid.columns, plan.grid.rows);
    make_output_folders(options_);

    const double broadcast_begin = now_s();
    farm_.transport.broadcast(Channel::command, encode_load_code(encode_plan(plan)));
    farm_.load_data(
        loaded_->compiled.block.bytes(), [this](const std::string& text) { log_->warn(text); },
        roll_call.make_node_witness());
    is_loaded_ = true;
    result_.times.broadcast_s = now_s() - broadcast_begin;
    log_->debug("the scene is loaded everywhere; tracing begins");

    farm_options.image = {
        settings.width_px, settings.height_px, settings.crop, make_pixel_layout(settings.pixel_format), {}};
    farm_options.node_timeout_s = options_.node_timeout_s;
    farm_options.signs = roll_call.signs();
    farm_options.progress = options_.is_quiet ? ProgressStyle::none : options_.progress;
    {
      FarmHost host(farm_.transport, farm_options, result_,
                    [this](const std::string& text) { log_->warn(text); });
      host.run();
    }
    result_.times.total_s = now_s() - begin_;
    mark_silent_nodes(farm_.transport, roll_call.signs(), result_);
    return report(plan, settings);
  }

  /// Says what came of it. What can't be told leaves the pictures whole, but not the exit code 0.
  int report(const JobPlan& plan, const RenderSettings& settings) {
    const TrafficMeter& meter = *farm_.transport.meter();
    if (!options_.is_quiet)
      say("{}",
          options_.is_full_report ? format_full_report(result_, meter, plan) : format_report(result_, meter));
    for (const FrameResult& frame : result_.frames)
      if (frame.is_written) std::fprintf(stdout, "%s\n", frame.file.c_str());
    bool is_told = flush_results();
    try {
      if (!options_.stats.empty())
        write_statistics(options_.stats, result_, meter, plan, settings, farm_.ranks);
      if (!options_.cost_map.empty()) write_cost_map(options_.cost_map, result_, plan.grid);
    } catch (const IoError& e) {
      log_->error(e.what());
      is_told = false;
    }
    if (result_.was_interrupted)
      throw JobError(kStopped, "stopped; finished frames are in place (--skip-existing goes on from there)");
    if (result_.lost_all_nodes) {
      const std::string problem = result_.first_problem();
      throw JobError(kRenderFailure, problem.empty() ? "every node is lost"
                                                     : fmt::format("every node is lost ({})", problem));
    }
    for (const FrameResult& frame : result_.frames)
      if (!frame.problem.empty()) log_->error("frame {} failed: {}", frame.frame, frame.problem);
    if (result_.frames_failed() == 0) return is_told ? kComplete : kRenderFailure;
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
