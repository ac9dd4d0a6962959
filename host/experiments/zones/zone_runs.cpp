#include "host/experiments/zones/zone_runs.h"

#include <fmt/core.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <ctime>
#include <exception>
#include <mutex>
#include <thread>

#include "common/lighting/zones/zone_solver.h"
#include "host/experiments/page.h"
#include "host/files/text_file.h"

namespace rayfarm {
namespace {

constexpr int kBlock_px = 16;
constexpr uint64_t kReferenceSeed = 1'000'000;

/// RMS of the differences of blocks' means over pixels that count; blocks of which less than a half do, and
/// parts of blocks at the right and the bottom, don't.
double block_rms(const FloatPicture& a, const FloatPicture& b, const PicturedScene& scene,
                 const CountedPixels& counted) {
  const int width = scene.width_px(), height = scene.height_px(), side = std::min({kBlock_px, width, height});
  double squares = 0;
  int blocks = 0;
  for (int y0 = 0; y0 + side <= height; y0 += side)
    for (int x0 = 0; x0 + side <= width; x0 += side) {
      Color sum(0);
      int pixels = 0;
      for (int y = y0; y < y0 + side; ++y)
        for (int x = x0; x < x0 + side; ++x) {
          const auto pixel = static_cast<size_t>(y * width + x);
          if (!counted.empty() && !counted[pixel]) continue;
          ++pixels;
          for (int c = 0; c < 3; ++c) {
            const size_t i = 3 * pixel + static_cast<size_t>(c);
            sum[c] += double{a.values[i]} - double{b.values[i]};
          }
        }
      if (2 * pixels < side * side) continue;
      squares += glm::dot(sum, sum) / (3.0 * pixels * pixels);
      ++blocks;
    }
  return blocks > 0 ? std::sqrt(squares / blocks) : 0;
}

/// Of all channels of the pixels that count.
double mean_of(const FloatPicture& picture, const CountedPixels& counted) {
  double sum = 0, values = 0;
  for (size_t i = 0; i < picture.values.size(); ++i) {
    if (!counted.empty() && !counted[i / 3]) continue;
    sum += double{picture.values[i]};
    ++values;
  }
  return values > 0 ? sum / values : 1;
}

}  // namespace

ZoneWork::ZoneWork(const ExperimentOptions& options)
    : width_px_(options.width_px > 0 ? options.width_px : kWidth_px),
      share_(std::pow(std::min(1.0, double(width_px_) / kWidth_px), 2)),
      scenes_(options.scenes),
      folder_(make_page_folder(options.output)),
      scratch_(make_page_folder((folder_ / "scratch").string())) {}

ZoneWork::~ZoneWork() {
  std::error_code ignored;
  std::filesystem::remove_all(scratch_, ignored);
}

std::string ZoneWork::path_of(const std::string& scene) const {
  return (std::filesystem::path(scenes_) / scene).string();
}

PicturedScene ZoneWork::scene(const std::string& name) const {
  return {path_of(name), width_px_};
}

PicturedScene ZoneWork::scene_of(const std::string& text) const {
  const std::string path = scratch("scene.yaml").string();
  write_text_file(path, text);
  return {path, width_px_};
}

double cpu_time() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

SolvedZoneLight solve_zone_light(const Scene& scene, const RenderSettings& settings) {
  const double cpu_before = cpu_time();
  const auto begin = std::chrono::steady_clock::now();
  SolvedZoneLight solved;
  const std::unique_ptr<ZoneSolver> solver = make_zone_solver(scene, settings, 0);
  std::vector<std::unique_ptr<ZoneTracer>> tracers(std::max(1u, std::thread::hardware_concurrency()));
  for (auto& tracer : tracers) tracer = make_zone_tracer(scene, settings, 0);
  double before = 0;  // rays of rounds that are over
  const auto note = [&] {
    const ZoneProgress progress = solver->progress();
    solved.course.push_back({static_cast<double>(progress.rounds), before, progress.unsent});
    before = static_cast<double>(progress.rays);
  };
  while (const auto stage = solver->next_stage()) {
    note();
    const uint64_t items = stage->items();
    std::atomic<uint64_t> next = 0;
    std::mutex mutex;  // of the solver, the counts and `failure`
    std::exception_ptr failure;
    const auto work = [&](ZoneTracer& tracer) {
      try {
        tracer.begin(stage->data);
        for (uint64_t item; (item = next.fetch_add(1)) < items;) {
          const uint64_t first = item * stage->units_per_item;
          const ZoneItemResult result =
              tracer.work(first, std::min(stage->units_per_item, stage->units - first), [] {});
          const std::lock_guard lock(mutex);
          solver->add(item, result.bytes);
          solved.rays += result.rays;
        }
      } catch (...) {
        const std::lock_guard lock(mutex);
        failure = std::current_exception();
        next = items;
      }
    };
    std::vector<std::thread> others;
    for (size_t i = 1; i < std::min<uint64_t>(tracers.size(), items); ++i)
      others.emplace_back([&, i] { work(*tracers[i]); });
    work(*tracers[0]);
    for (std::thread& thread : others) thread.join();
    if (failure) std::rethrow_exception(failure);
  }
  solved.bytes = solver->solution();
  solved.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  solved.cpu_s = cpu_time() - cpu_before;
  return solved;
}

RenderSettings zone_experiment_settings(LightingModel model, uint32_t samples) {
  RenderSettings settings;
  settings.lighting = model;
  settings.samples = samples;
  if (follows_paths(model)) limit_by_depth(settings, kPathDepth);
  return settings;
}

PathReference make_path_reference(const PicturedScene& scene, uint32_t samples, int frame,
                                  const CountedPixels& counted) {
  RenderSettings settings = zone_experiment_settings(LightingModel::path, std::max(1u, samples / 2));
  settings.seed = kReferenceSeed;
  PathReference reference;
  reference.counted = counted;
  reference.picture = scene.render(settings, frame);
  settings.seed = kReferenceSeed + 1;
  const FloatPicture other = scene.render(settings, frame);
  const double of_pixels = difference(reference.picture, other).rms / 2,
               of_blocks = block_rms(reference.picture, other, scene, counted) / 2;
  for (size_t i = 0; i < other.values.size(); ++i)
    reference.picture.values[i] = (reference.picture.values[i] + other.values[i]) / 2;
  reference.mean = mean_of(reference.picture, counted);
  reference.pixel_noise = of_pixels / reference.mean;
  reference.block_noise = of_blocks / reference.mean;
  return reference;
}

PictureError picture_error(const PicturedScene& scene, const FloatPicture& picture,
                           const PathReference& reference) {
  return {block_rms(picture, reference.picture, scene, reference.counted) / reference.mean,
          difference(picture, reference.picture).rms / reference.mean};
}

void tell_zones(const std::string& what) {
  fmt::print(stderr, "zones: {}\n", what);
}

std::string percent(double part) {
  return fmt::format("{:.3g} %", 100 * part);
}

}  // namespace rayfarm
