#include "host/render/render_job.h"

#include <fmt/core.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <csignal>
#include <filesystem>

#include "common/files/whole_file.h"
#include "common/scene/camera.h"
#include "host/bake/bake.h"
#include "host/farm/dismissal.h"
#include "host/farm/farm_host.h"
#include "host/farm/preview.h"
#include "host/farm/report.h"
#include "host/farm/roll_call.h"
#include "host/farm/statistics.h"
#include "host/instrument/cost_map.h"
#include "host/process/console.h"
#include "host/process/exit_code.h"
#include "host/process/interrupt.h"
#include "host/render/choices.h"
#include "host/render/frame_groups.h"
#include "host/render/journals.h"
#include "host/render/notes.h"
#include "host/render/onlookers.h"
#include "host/render/output_pattern.h"
#include "host/render/outputs.h"
#include "host/render/reception.h"
#include "host/render/zone_solvers.h"
#include "host/render/zones_file.h"
#include "protocol/clock.h"

namespace rayfarm {
namespace {

/// Sending that takes longer is shown.
constexpr double kLongSending_s = 1;

class Render {
 public:
  Render(const RenderOptions& options, Farm& farm) : options_(options), farm_(farm) {
    log_ = spdlog::stderr_color_mt("rayfarm");
    log_->set_pattern("rayfarm: %v");
    log_->set_level(options.is_quiet     ? spdlog::level::err
                    : options.is_verbose ? spdlog::level::debug
                                         : spdlog::level::info);
    begin_ = now_s();
    if (options.most_time_s > 0) interrupt_after(options.most_time_s);
  }
  ~Render() { spdlog::drop("rayfarm"); }
  Render(const Render&) = delete;
  Render& operator=(const Render&) = delete;

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
      log_->error(
          "out of memory; a smaller --size or --frame-memory, or a machine with more memory, is needed");
      ending.exit_code = kRenderFailure;
    } catch (const std::exception& e) {
      log_->error(e.what());
      ending.exit_code = kRenderFailure;
    }
    if (is_loaded_) ending.has_hung_nodes = end_hung_nodes(farm_.transport, result_);
    ending.has_losses = !result_.lost_nodes().empty();
    dismiss_nodes(farm_.transport, ending.has_losses);
    farm_.wait_for_nodes();  // they may still trace in the scene that ends with this object
    if (onlookers_) onlookers_->end(ending.exit_code);
    return ending;
  }

 private:
  int render() {
    check_outputs(options_);
    for (const std::string& note : name_idle_options(options_, farm_.transport.is_one_process()))
      log_->warn(note);
    onlookers_.emplace(options_, [this](const std::string& text) { log_->warn(text); });
    RollCall roll_call(farm_.transport, result_);
    loaded_ = load_while_nodes_report(options_, roll_call);
    options_ = loaded_->options;
    return render_loaded(roll_call);
  }

  /// A frame to render, its file, and what an earlier run left of it.
  struct Picture {
    FrameNumber frame;
    std::string file;
    std::optional<JournalHead> journal;
  };

  /// Frames whose pictures are there are left out, if that is asked for. Throws JobError and InputError.
  std::vector<Picture> choose_pictures(const RenderSettings& settings,
                                       const std::map<std::string, std::string>& attributes,
                                       const JournalLines& journal_lines) const {
    std::vector<Picture> pictures;
    for (const FrameNumber frame : choose_frames(options_, loaded_->description)) {
      if (interrupted_by() != 0) throw JobError(kStopped, "stopped before anything was traced");
      const std::string file = file_of_frame(options_.output, frame);
      std::error_code ignored;
      if ((options_.skip_existing || options_.resume) && std::filesystem::exists(file, ignored)) {
        const std::string why = why_not_finished(file, settings, frame, attributes);
        if (why.empty()) {
          remove_leftovers(file);
          log_->info("{} is there; frame {} is skipped", file, frame.value());
          continue;
        }
        log_->warn("{} {}; frame {} is rendered again", file, why, frame.value());
      }
      for (const std::string& other : {options_.stats, options_.cost_map, options_.zones_file})
        if (!other.empty() && (other == file || other == journal_of(file) || other == preview_of(file)))
          throw JobError(
              kUsageError,
              fmt::format("{} is the name of a file of frame {}, and of --stats, --cost-map or --zones; "
                          "each output needs a name of its own",
                          other, frame.value()));
      try {
        make_camera(loaded_->compiled.scene, frame.value(), settings.width_px, settings.height_px,
                    settings.fit);
      } catch (const std::domain_error& e) {
        throw InputError({options_.scene}, fmt::format("at frame {}: {}", frame.value(), e.what()));
      }
      refuse_if_in_work(file);
      std::optional<JournalHead> journal;
      if (options_.resume) {
        journal = find_journal(file, frame, journal_lines);
      } else if (holds_work_of(file, frame, journal_lines)) {
        throw JobError(
            kUsageError,
            fmt::format("{} holds work of an earlier run of this very job: --resume goes on from there; "
                        "remove it to begin anew",
                        journal_of(file)));
      }
      if (!journal) remove_leftovers(file);  // of other jobs
      pictures.push_back({frame, file, std::move(journal)});
    }
    return pictures;
  }

  /// Where pictures take light from zones. Files of zones are looked through now: what is wrong with one is
  /// told before hours of work.
  void choose_zones(const RenderSettings& settings, FarmHostOptions& farm_options) {
    const Scene& scene = loaded_->compiled.scene;
    const MakeZoneSolver make_solver = zone_solvers_of(settings);
    const std::string& name = options_.zones_file;
    if (!make_solver) {
      if (!name.empty()) log_->warn("--zones belongs to lighting models with zones, and does nothing here");
      return;
    }
    const std::vector<FrameNumber>& frames = farm_options.plan.pictures.frames;
    farm_options.groups = group_frames(scene, frames.size());
    farm_options.zones.make_solver = [&scene, settings, make_solver](FrameNumber frame) {
      return make_solver(scene, settings, frame.value());
    };
    if (name.empty()) return;
    if (farm_options.groups.size() > 1 && !has_frame_pattern(name))
      throw JobError(kUsageError,
                     fmt::format("--zones {}: things move, so that each frame has zones of its own; put #### "
                                 "into the name",
                                 name));
    const auto file = std::make_shared<ZonesFile>(name, scene, settings, has_poses(scene));
    // Where nothing moves, the file of any frame will do.
    const std::vector<FrameNumber> all = has_poses(scene) ? std::vector<FrameNumber>() : frames;
    const auto look = [file, all](FrameNumber first) {
      std::optional<Bytes> solution = file->read(first);
      FrameNumber of = first;
      for (size_t i = 0; i < all.size() && !solution; ++i) solution = file->read(of = all[i]);
      return std::pair(std::move(solution), of);
    };
    for (const FrameGroup& group : farm_options.groups) look(frames[group.first.place()]);
    farm_options.zones.find = [this, file, look](FrameNumber frame) {
      auto [solution, of] = look(frame);
      if (solution) log_->info("{} has the light of all zones; it is not computed again", file->file_of(of));
      return solution;
    };
    farm_options.zones.keep = [this, file](FrameNumber frame, std::span<const std::byte> solution) {
      try {
        file->write(frame, solution);
      } catch (const IoError& e) {  // the pictures can be made without it
        log_->error(e.what());
        is_zones_file_missing_ = true;
      }
    };
  }

  /// What can't be baked is told before hours of work.
  void prepare_bake(const RenderSettings& settings, FarmHostOptions& farm_options) {
    bake_.emplace(farm_options.files.front(), options_.scene, loaded_->description, loaded_->compiled,
                  settings, farm_options.plan.pictures.frames.front().value());
    for (const std::string& note : bake_->notes()) log_->warn(note);
    farm_options.zones.take = [this](FrameNumber, Bytes solution) { solution_ = std::move(solution); };
  }

  /// Nothing is written of a job that did not come to its end.
  void write_bake(const FarmHostOptions& farm_options) {
    if (!solution_) return;
    FrameResult& frame = result_.frames.front();
    auto attributes = farm_options.attributes;
    attributes["rayfarm/frame"] = fmt::format("{}", frame.frame.value());
    const double begin = now_s();
    baked_ = fmt::format("{}: {}", frame.file, bake_->write(*solution_, *options_.bake, attributes));
    result_.times.write_s = now_s() - begin;
    frame.is_written = true;
  }

  int render_loaded(const RollCall& roll_call) {
    result_.times.load_s = loaded_->load_s;
    result_.times.build_s = loaded_->build_s;
    result_.scene_bytes = loaded_->compiled.block.size;
    for (const std::string& note : loaded_->compiled.notes.lines()) log_->warn(note);
    const SceneDescription& scene = loaded_->description;
    if (!options_.adopt && !scene.render.empty())
      log_->warn("{}: `render` is for `rayfarm render`, and does nothing here",
                 to_string(scene.source(scene.render.front().place)));

    const RenderSettings settings = choose_settings(options_, loaded_->description);
    for (const std::string& note : name_idle_options(settings, loaded_->description)) log_->warn(note);
    for (const std::string& note : name_frames_outside(options_, loaded_->description)) log_->warn(note);
    for (const std::string& note : name_fit(options_, settings, loaded_->description.view)) log_->info(note);
    for (const std::string& note : name_open_objects(settings, loaded_->description, loaded_->open_objects))
      log_->warn(note);
    for (const std::string& note : name_idle_shading(settings, loaded_->compiled.scene)) log_->warn(note);
    for (const std::string& note : name_idle_items(settings, loaded_->compiled.scene)) log_->warn(note);
    for (const std::string& note : name_idle_spectra(settings, loaded_->compiled.scene)) log_->warn(note);
    FarmHostOptions farm_options;
    farm_options.attributes = make_attributes(settings, loaded_->compiled.block.bytes());
    farm_options.journals.every_s = options_.bake ? 0 : options_.journal_every_s;
    farm_options.journals.lines = journal_lines(settings, farm_options.attributes);
    farm_options.journals.lines.emplace_back("--passes", fmt::format("{}", options_.passes));
    farm_options.passes = {settings.samples, running_bytes_of(settings)};
    std::vector<FrameNumber> frames;
    for (Picture& picture : choose_pictures(settings, farm_options.attributes, farm_options.journals.lines)) {
      if (picture.journal)
        farm_options.journals.found.emplace(FrameIndex(static_cast<int>(frames.size())),
                                            std::move(*picture.journal));
      frames.push_back(picture.frame);
      farm_options.files.push_back(picture.file);
    }
    check_outputs_are_no_inputs(options_, farm_options.files, loaded_->description.files);
    // The machine's copy of the scene is still to come.
    const size_t copy_bytes = farm_.transport.is_one_process() ? 0 : loaded_->compiled.block.size;
    farm_options.frame_bytes = choose_frame_bytes(options_, copy_bytes);
    farm_options.image = {
        settings.width_px, settings.height_px, settings.crop, make_pixel_layout(settings.pixel_format), {}};
    farm_options.plan =
        make_plan(options_, settings, frames, farm_.transport.node_count(), farm_options.frame_bytes);
    for (const std::string& note : adopt_journals(settings.crop, options_, farm_options)) log_->info(note);
    const JobPlan& plan = farm_options.plan;
    const SubpolygonGrid& grid = plan.pictures.grid;
    if (frames.empty()) {
      log_->info("nothing to do");
      return kComplete;
    }
    if (options_.bake) prepare_bake(settings, farm_options);
    if (!options_.bake) {
      farm_options.window_frames =
          choose_window(settings, grid, farm_options.frame_bytes, copy_bytes, options_.passes);
      for (const std::string& note : name_streaming(options_, farm_options)) log_->info(note);
    }
    if (!options_.bake && options_.wire == Wire::pixel &&
        natural_format(options_.output) != PixelFormat::rgb8)
      log_->warn("the pixel wire carries 8 bits a channel: the EXR holds no more than that");
    log_->debug("{} nodes, {} subpolygons", plan.processors, grid.text());
    if (!options_.bake)
      for (const std::string& note : name_limits(options_, grid, plan.processors)) log_->warn(note);
    choose_zones(settings, farm_options);
    make_output_folders(options_);

    const double broadcast_begin = now_s();
    farm_.transport.set_beat_s(plan.beat_s);
    farm_.transport.load_code(encode_load_code(encode_plan(plan)), roll_call.make_node_witness());
    // Zones and files of baked light look at the scene here, too; else the host has no use for it any more,
    // and its bytes go as the nodes' copies come.
    const bool is_spent =
        !farm_.transport.is_one_process() && !options_.bake && !farm_options.zones.make_solver;
    SceneBlock& block = loaded_->compiled.block;
    if (is_spent) loaded_->compiled.scene = {};
    size_t released = 0;
    Progress progress(options_.is_quiet ? ProgressStyle::none : options_.progress);
    farm_.load_data(
        block.bytes(),
        [&](size_t sent) {
          if (const double since_s = now_s() - broadcast_begin; since_s > kLongSending_s)
            progress.show_bytes("sending", since_s, sent, loaded_->compiled.block.size);
          constexpr size_t kStep = 16 << 20;
          if (!is_spent || (sent < released + kStep && sent < block.size)) return;
          block.give_back(released, sent);
          released = sent;
        },
        [this](const std::string& text) { log_->warn(text); }, roll_call.make_node_witness());
    progress.clear();
    if (is_spent) block = {};
    is_loaded_ = true;
    result_.times.broadcast_s = now_s() - broadcast_begin;
    log_->debug("the scene is loaded everywhere; tracing begins");

    farm_options.keeps_traced_by = !options_.stats.empty() || options_.is_full_report;
    farm_options.keeps_costs = !options_.cost_map.empty();
    farm_options.node_timeout_s = options_.node_timeout_s;
    farm_options.signs = roll_call.signs();
    farm_options.watchers = onlookers_->watchers();
    farm_options.progress = options_.is_quiet ? ProgressStyle::none : options_.progress;
    {
      FarmHost host(farm_.transport, farm_options, result_,
                    [this](const std::string& text) { log_->warn(text); });
      host.run();
    }
    if (bake_) write_bake(farm_options);
    result_.times.total_s = now_s() - begin_;
    mark_silent_nodes(farm_.transport, roll_call.signs(), result_);
    return report(plan, settings);
  }

  /// Says what came of it. What can't be told leaves the pictures whole, but not the exit code 0.
  int report(const JobPlan& plan, const RenderSettings& settings) {
    const TrafficMeter& meter = *farm_.transport.meter();
    if (bake_ && !options_.is_quiet)
      say("{}", format_zones_report(result_, baked_.empty() ? "nothing" : baked_));
    else if (!options_.is_quiet)
      say("{}", options_.is_full_report ? format_full_report(result_, meter) : format_report(result_, meter));
    std::vector<std::string> written;
    for (const FrameResult& frame : result_.frames) {
      if (!frame.is_written) continue;
      written.push_back(frame.file);
      std::fprintf(stdout, "%s\n", frame.file.c_str());
      if (options_.resume) remove_leftovers(frame.file);
    }
    remove_stale_files(written);  // of jobs that were about to end when this one began
    bool is_told = flush_results() && !is_zones_file_missing_;
    try {
      if (!options_.stats.empty())
        write_statistics(options_.stats, result_, meter, plan, settings, farm_.ranks);
      if (!options_.cost_map.empty()) write_cost_map(options_.cost_map, result_, plan.pictures.grid);
    } catch (const std::runtime_error& e) {  // IoError, or a name that is no text
      log_->error(e.what());
      is_told = false;
    }
    for (const UnfinishedFrame& frame : result_.unfinished) {
      if (!frame.journal.empty())
        log_->info("frame {}: {:.1f} % of its pixels are in {}", frame.frame.value(), 100 * frame.share,
                   frame.journal);
      if (!frame.preview.empty())
        log_->info("frame {} can be looked at in {}", frame.frame.value(), frame.preview);
    }
    const auto& left = result_.unfinished;
    const bool can_resume = options_.journal_every_s > 0 &&
                            (left.empty() || std::any_of(left.begin(), left.end(), [](const auto& frame) {
                               return !frame.journal.empty();
                             }));
    if (result_.was_interrupted)
      throw JobError(kStopped,
                     fmt::format("stopped{}; frames that were finished are in place; {} goes on from there",
                                 interrupted_by() == SIGALRM ? " by --max-time" : "",
                                 can_resume ? "--resume" : "--skip-existing"));
    if (result_.lost_all_nodes) {
      const std::string problem = result_.first_problem();
      throw JobError(kRenderFailure, problem.empty() ? "every node is lost"
                                                     : fmt::format("every node is lost ({})", problem));
    }
    if (!result_.problem.empty()) throw JobError(kRenderFailure, result_.problem);
    for (const FrameResult& frame : result_.frames)
      if (!frame.problem.empty()) log_->error("frame {} failed: {}", frame.frame.value(), frame.problem);
    if (result_.frames_failed() == 0) return is_told ? kComplete : kRenderFailure;
    return result_.frames_failed() == result_.frames.size() ? kRenderFailure : kSomeFramesFailed;
  }

  RenderOptions options_;
  Farm& farm_;
  std::shared_ptr<spdlog::logger> log_;
  JobResult result_;
  std::optional<LoadedScene> loaded_;
  bool is_loaded_ = false;
  bool is_zones_file_missing_ = false;  ///< it could not be written
  std::optional<Bake> bake_;            ///< in place of pictures
  std::optional<Bytes> solution_;       ///< to be baked
  std::string baked_;                   ///< what was, a line
  double begin_ = 0;
  std::optional<Onlookers> onlookers_;  // last: they tell by the log
};

}  // namespace

Ending run_render(const RenderOptions& options, Farm& farm) {
  return Render(options, farm).run();
}

}  // namespace rayfarm
