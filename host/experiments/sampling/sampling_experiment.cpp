#include "host/experiments/sampling/sampling_experiment.h"

#include <fmt/core.h>

#include "host/experiments/page.h"
#include "host/experiments/pictures.h"
#include "host/experiments/sampling/sampling_page.h"
#include "host/process/exit_code.h"
#include "host/render/render_options.h"

namespace rayfarm {
namespace {

namespace fs = std::filesystem;

/// Those of the paper come first.
constexpr std::pair<const char*, SamplingPattern> kPatterns[] = {
    {"regular", SamplingPattern::regular},
    {"jittered", SamplingPattern::jittered},
    {"uncorrelated", SamplingPattern::uncorrelated},
    {"n-rooks", SamplingPattern::n_rooks},
    {"poisson", SamplingPattern::poisson},
    {"corners", SamplingPattern::corners},
    {"sobol", SamplingPattern::sobol}};

struct SceneOfExperiment {
  const char* name;
  const char* what;
  LightingModel lighting;
};
constexpr SceneOfExperiment kScenes[] = {
    {"edges_upright", "bars along rows and columns of pixels", LightingModel::whitted},
    {"edges_slanted", "thin triangles in all directions", LightingModel::whitted},
    {"textures", "checks to the horizon, bricks; textures average over a ray's width",
     LightingModel::whitted},
    {"soft_shadow", "half-shadows of a square lamp", LightingModel::whitted},
    {"gloss", "blurred reflections in rough metal, by paths with one reflection", LightingModel::path},
    {"depth_of_field", "a wide lens", LightingModel::whitted}};

/// 17 stands for numbers without factors, which the paper says jittering suffers from.
constexpr uint32_t kSamples[] = {1, 2, 4, 8, 16, 17, 32, 64, 128, 256};

/// References have so many times the most samples, and seeds of their own.
constexpr uint32_t kReferenceFactor = 16;
constexpr uint64_t kReferenceSeed = 1'000'000;

RenderSettings settings_of(const SceneOfExperiment& scene) {
  RenderSettings settings;
  settings.lighting = scene.lighting;
  if (scene.lighting == LightingModel::path) limit_by_depth(settings, 2);  // a lamp's light, once reflected
  return settings;
}

void set_pattern(RenderSettings& settings, SamplingPattern pattern, uint32_t samples) {
  settings.sampling = pattern;
  const Strata strata = make_strata(samples);
  if (pattern == SamplingPattern::corners)
    settings.subpixels = {strata.columns, strata.rows};
  else
    settings.samples = samples;
}

/// The mean of two pictures with seeds of their own; `error`: what half of their difference says of it.
FloatPicture make_reference(const PicturedScene& scene, RenderSettings settings, uint32_t samples,
                            double& error) {
  settings.samples = samples;
  settings.seed = kReferenceSeed;
  FloatPicture mean = scene.render(settings);
  settings.seed = kReferenceSeed + 1;
  const FloatPicture other = scene.render(settings);
  error = difference(mean, other).rms / 2;
  for (size_t i = 0; i < mean.values.size(); ++i) mean.values[i] = (mean.values[i] + other.values[i]) / 2;
  return mean;
}

SampledScene measure(const SceneOfExperiment& of, const PicturedScene& scene, const SamplingPage& page,
                     uint32_t seeds) {
  SampledScene result{of.name, of.what, 0, {}};
  const FloatPicture reference =
      make_reference(scene, settings_of(of), page.reference_samples, result.reference_error);
  for (const auto& [name, pattern] : kPatterns) {
    auto& errors = result.errors.emplace_back();
    for (const uint32_t samples : page.samples) {
      RenderSettings settings = settings_of(of);
      set_pattern(settings, pattern, samples);
      ErrorsOfSeeds& of_seeds = errors.emplace_back();
      for (settings.seed = 0; settings.seed < seeds; ++settings.seed)
        of_seeds.push_back(difference(scene.render(settings), reference).rms);
    }
  }
  return result;
}

}  // namespace

int run_sampling_experiment(const ExperimentOptions& options, const RunRender& render) {
  const fs::path folder = make_page_folder(options.output);
  SamplingPage page;
  for (const auto& pattern : kPatterns) page.patterns.emplace_back(pattern.first);
  const uint32_t most = options.samples.value_or(256), seeds = options.seeds.value_or(5);
  for (const uint32_t samples : kSamples)
    if (samples <= most) page.samples.push_back(samples);
  page.reference_samples = kReferenceFactor * page.samples.back();
  for (const SceneOfExperiment& of : kScenes) {
    fmt::print(stderr, "sampling: {}\n", of.name);
    RenderOptions job;
    job.scene = (fs::path(options.scenes) / "sampling" / fmt::format("{}.yaml", of.name)).string();
    job.output = (folder / fmt::format("{}.png", of.name)).string();
    job.settings = settings_of(of);
    job.settings.samples = page.samples.back();
    const int width = options.width_px > 0 ? options.width_px : 240;
    job.size_px = {width, std::max(1, width * 3 / 4)};
    job.is_quiet = true;
    if (const int code = render(job); code != kComplete) return code;
    page.scenes.push_back(measure(of, PicturedScene(job.scene, options.width_px), page, seeds));
  }
  write_sampling_page(page, folder);
  fmt::print("{}\n", (folder / "README.md").string());
  return kComplete;
}

}  // namespace rayfarm
